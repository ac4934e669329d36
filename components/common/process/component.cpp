#include "common/process/component.h"

#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <thread>
#include <utility>

#include "common/config/config_error.h"
#include "common/process/allocation_limit.h"
#include "common/process/certificate.h"
#include "common/process/command_line.h"
#include "common/process/component_servant.h"
#include "common/process/cpu_meter.h"
#include "common/process/faces.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/process/parameter_table.h"
#include "common/process/process_configuration.h"
#include "common/process/ready_line.h"
#include "common/process/registration.h"
#include "common/process/robot_identity.h"
#include "common/process/service_manager.h"
#include "common/process/status.h"

namespace vismem {
namespace {

// Sanitizers slow a program down by about this much.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kSanitizerFactor = 5;
#else
constexpr int kSanitizerFactor = 1;
#endif

/// Arenas of the allocator. With one for each thread of Ice, memory of large requests would stay in all of
/// them.
constexpr int kMemoryArenas = 2;

/// The first reason and request to end the process. Thread-safe.
class StopRequest {
 public:
  explicit StopRequest(std::string name) : name_(std::move(name)) {}

  /// Only the first request counts.
  void request(const std::string& why, std::exception_ptr failure = nullptr) {
    const std::scoped_lock lock(mutex_);
    if (requested_) return;
    requested_ = true;
    why_ = why;
    failure_ = std::move(failure);
    changed_.notify_all();
    endInTime();
  }

  /// Waits for a request and calls `look` every half second meanwhile.
  /// @return the reason.
  std::string wait(const std::function<void()>& look) {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kLookInterval, [this] { return requested_; })) {
      lock.unlock();
      look();
      lock.lock();
    }
    return why_;
  }

  void rethrowFailure() {
    const std::scoped_lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  static constexpr std::chrono::milliseconds kLookInterval{500};

  /// Ends the process if a peer, a driver or a client hangs. The thread uses no member of this object,
  /// because main may have returned by then.
  void endInTime() const {
    std::thread([name = name_] {
      std::this_thread::sleep_for(kSanitizerFactor * kStopWithin);
      const std::string text = name + " ERROR did not stop within " +
                               std::to_string((kSanitizerFactor * kStopWithin).count()) +
                               " s: it ends at once\n";
      [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
      _exit(kExitFailure);
    }).detach();
  }

  const std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool requested_ = false;
  std::string why_;
  std::exception_ptr failure_;
};

class Host : public ComponentHost {
 public:
  Host(Logger& log, StatusBoard& status, StopRequest& stop, RobotKeys robot,
       std::shared_ptr<Ice::Communicator> communicator, std::shared_ptr<Ice::ObjectAdapter> adapter,
       std::shared_ptr<Ice::ObjectAdapter> web_adapter)
      : log_(log),
        status_(status),
        stop_(stop),
        robot_(std::move(robot)),
        communicator_(std::move(communicator)),
        adapter_(std::move(adapter)),
        web_adapter_(std::move(web_adapter)) {
    addViewFace(*adapter_, robot_, objects_);
    if (web_adapter_) addWebFaces(*web_adapter_, robot_, objects_);
  }

  Logger& log() override { return log_; }
  StatusBoard& status() override { return status_; }
  const std::shared_ptr<Ice::Communicator>& communicator() override { return communicator_; }
  ParameterTable& parameters() override { return parameters_; }
  const std::shared_ptr<Ice::ObjectAdapter>& adapter() override { return adapter_; }
  /// Null: nothing is served over WebSocket.
  const std::shared_ptr<Ice::ObjectAdapter>& webAdapter() { return web_adapter_; }
  void serve(const std::string& identity, const std::shared_ptr<Ice::Object>& servant) override {
    adapter_->add(servant, Ice::stringToIdentity(ownIdentity(robot_, identity)));
    objects_->add(faceName(identity), servant);
  }
  void requestStop() override { stop_.request("its work is done"); }
  void fail(std::exception_ptr failure) override { stop_.request("it has failed", std::move(failure)); }

 private:
  Logger& log_;
  StatusBoard& status_;
  StopRequest& stop_;
  const RobotKeys robot_;
  ParameterTable parameters_;
  const std::shared_ptr<FaceObjects> objects_ = std::make_shared<FaceObjects>();
  const std::shared_ptr<Ice::Communicator> communicator_;
  const std::shared_ptr<Ice::ObjectAdapter> adapter_;
  const std::shared_ptr<Ice::ObjectAdapter> web_adapter_;
};

/// Stops all started parts, also after a failed start, in this order.
class Ending {
 public:
  Ending(Component& component, Host& host, ServiceManager& manager, Registration& registration)
      : component_(component), host_(host), manager_(manager), registration_(registration) {}
  ~Ending() {
    manager_.stopping();
    host_.status().stopping();
    registration_.withdraw();
    host_.adapter()->deactivate();
    if (host_.webAdapter()) host_.webAdapter()->deactivate();
    try {
      component_.stop();
    } catch (const std::exception& failure) {
      host_.log().error("while stopping: " + describeFailure(failure));
    }
    // Waits for the requests in flight, because they use the objects that are destroyed next.
    host_.communicator()->destroy();
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

 private:
  Component& component_;
  Host& host_;
  ServiceManager& manager_;
  Registration& registration_;
};

/// Raises the limit of descriptors: idle connections of untrusted clients must not use up all of them.
void allowManyConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 65'536);
  setrlimit(RLIMIT_NOFILE, &limit);
}

/// The levels as a number, so that one operation sets every parameter.
void addLogLevel(Host& host, LogLevel configured) {
  host.parameters().add({"Log.Level", "", static_cast<double>(LogLevel::kDebug),
                         static_cast<double>(LogLevel::kError), true, static_cast<double>(configured),
                         "Messages below this level are not logged: 0 debug, 1 info, 2 warning, 3 error"},
                        [&log = host.log()](double level) {
                          log.setLowest(static_cast<LogLevel>(static_cast<int>(level)));
                          return std::string();
                        });
}

std::string readyLineOf(const ComponentSpec& spec, Host& host) {
  const auto& web = host.webAdapter();
  return readyLine(spec.name, host.adapter()->getName(), publishedEndpoints(*host.adapter()),
                   webAdapterName(spec), web ? publishedEndpoints(*web) : std::string());
}

/// Says loudly when other machines reach this process.
void reportOpenEndpoints(Host& host) {
  const auto report = [&](Ice::ObjectAdapter& adapter, const std::string& who) {
    const std::string open = openEndpoints(adapter);
    if (!open.empty()) host.status().error("open to other machines: " + open + " (" + who + ")");
  };
  report(*host.adapter(), "whoever reaches it commands this component; 127.0.0.1 keeps it to this machine");
  if (host.webAdapter()) report(*host.webAdapter(), "to pages with the token");
}

void serveUntilStopped(const ComponentSpec& spec, const ProcessKeys& keys, Component& component, Host& host,
                       StopRequest& stop) {
  ServiceManager manager(ServiceManager::socketOfEnvironment());
  const auto certificate = OwnCertificate::of(*host.communicator());
  Registration registration(host.communicator(), {host.adapter(), host.webAdapter()}, host.status());
  const Ending ending(component, host, manager, registration);
  CpuMeter cpu;
  const auto measure = [&] {
    cpu.add(std::chrono::steady_clock::now(), processorTime_s());
    host.status().gauge({"cpu", cpu.percent(), 0.0, "%"});
    if (certificate) certificate->look(host.status(), std::chrono::system_clock::now());
  };
  measure();
  addLogLevel(host, keys.log_level);
  host.serve(spec.name + "/component",
             std::make_shared<ComponentServant>(host.status(), host.log().history(), host.parameters()));
  component.start(host);
  host.adapter()->activate();
  if (host.webAdapter()) host.webAdapter()->activate();
  registration.begin();
  host.status().serving();
  reportOpenEndpoints(host);
  std::cout << readyLineOf(spec, host) << std::endl;
  manager.ready(host.status().stateLine());
  host.log().info("stopping: " + stop.wait([&] {
    const bool progress = host.status().checkProgress();
    measure();
    manager.report(host.status().stateLine(), progress);
    // Over Ice.Admin, as an IceGrid node ends its servers.
    if (host.communicator()->isShutdown()) stop.request("a shutdown over Ice.Admin");
  }));
}

/// The value of a variable of the environment; empty without it.
std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

void runConfigured(const ComponentSpec& spec, const Properties& properties, Logger& log, StopRequest& stop) {
  ConfigReader config(properties);
  const auto keys = readProcessKeys(config, spec);
  log.setLowest(keys.log_level);
  log.conceal(keys.robot.token);
  log.conceal(keys.robot.view_token);
  auto [component, communicator] = configure(spec, properties, config, keys, log);
  for (const auto& renamed : config.renamedKeys()) log.warning(renamed.text());
  allowManyConnections();
  if (keys.end_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);

  const auto settings = effectiveConfiguration(config, properties);
  StatusBoard status(spec.name, VISMEM_VERSION, log);
  status.setConfiguration(settings);
  const auto adapter =
      makeAdapter(*communicator.communicator(), adapterName(spec), keys.endpoints.key, keys.endpoints.value);
  std::shared_ptr<Ice::ObjectAdapter> web_adapter;
  if (keys.robot.servesWeb() && !keys.web_endpoints.value.empty()) {
    web_adapter = makeAdapter(*communicator.communicator(), webAdapterName(spec), keys.web_endpoints.key,
                              keys.web_endpoints.value);
  }
  log.info(configurationText(settings));
  Host host(log, status, stop, keys.robot, communicator.communicator(), adapter, web_adapter);
  serveUntilStopped(spec, keys, *component, host, stop);
  component.reset();
  stop.rethrowFailure();
}

/// On a terminal the problems alone, one a line; the journal needs the level, too.
void reportWrongConfiguration(Logger& log, const ConfigError& error) {
  if (log.format() == Logger::Format::kJournal)
    log.error(error.what());
  else
    std::cerr << error.what() << std::endl;
}

}  // namespace

int runComponent(int argc, char** argv, const ComponentSpec& spec) {
  StopRequest stop(spec.name);
  bool is_signalled = false;
  const Ice::CtrlCHandler signals([&](int number) {
    // A second signal ends the process at once.
    if (std::exchange(is_signalled, true)) _exit(128 + number);
    stop.request("signal " + std::to_string(number));
  });
  Logger log(spec.name);
  // A file that reaches `ulimit -f` is a failed write, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);
  limitAllocations(kLargestAllocation);
  mallopt(M_ARENA_MAX, kMemoryArenas);
  try {
    auto line = parseCommandLine({argv + std::min(argc, 1), argv + argc}, environment("ICE_CONFIG"));
    switch (line.action) {
      case CommandLine::Action::kListKeys:
        printKeys(spec, line.properties);
        return kExitClean;
      case CommandLine::Action::kHelp:
        printHelp(spec, line.properties);
        return kExitClean;
      case CommandLine::Action::kVersion:
        std::cout << spec.name << " " << VISMEM_VERSION << std::endl;
        return kExitClean;
      case CommandLine::Action::kRun:
        break;
    }
    addCredentials(line.properties, environment("CREDENTIALS_DIRECTORY"));
    runConfigured(spec, line.properties, log, stop);
    return kExitClean;
  } catch (const ConfigError& error) {
    reportWrongConfiguration(log, error);
    return kExitConfiguration;
  } catch (const std::exception& failure) {
    log.error(describeFailure(failure));
  } catch (...) {
    log.error("something was thrown that is no std::exception");
  }
  return kExitFailure;
}

}  // namespace vismem
