#include "common/process/component.h"

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

#include "common/config/config_error.h"
#include "common/process/allocation_limit.h"
#include "common/process/command_line.h"
#include "common/process/component_servant.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/process/ready_line.h"
#include "common/process/status.h"

namespace vismem {
namespace {

// Sanitizers slow a program down by about this much.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kSanitizerFactor = 5;
#else
constexpr int kSanitizerFactor = 1;
#endif

/// Why and when the process shall end. Thread-safe.
class StopRequest {
 public:
  explicit StopRequest(std::string name) : name_(std::move(name)) {}

  /// @return whether this was the first request.
  bool request(const std::string& why, std::exception_ptr failure = nullptr) {
    const std::scoped_lock lock(mutex_);
    if (requested_) return false;
    requested_ = true;
    why_ = why;
    failure_ = std::move(failure);
    changed_.notify_all();
    endInTime();
    return true;
  }

  /// Calls `look` every half second meanwhile. @return why.
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

  /// A peer, a driver or a client that hangs must not keep the process: a request that nobody answers would.
  /// Nothing of this object is used, for main may have returned by then, which ends the thread.
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
  Host(Logger& log, StatusBoard& status, StopRequest& stop, std::shared_ptr<Ice::Communicator> communicator,
       std::shared_ptr<Ice::ObjectAdapter> adapter)
      : log_(log),
        status_(status),
        stop_(stop),
        communicator_(std::move(communicator)),
        adapter_(std::move(adapter)) {}

  Logger& log() override { return log_; }
  StatusBoard& status() override { return status_; }
  const std::shared_ptr<Ice::Communicator>& communicator() override { return communicator_; }
  const std::shared_ptr<Ice::ObjectAdapter>& adapter() override { return adapter_; }
  void requestStop() override { stop_.request("its work is done"); }
  void fail(std::exception_ptr failure) override { stop_.request("it has failed", std::move(failure)); }

 private:
  Logger& log_;
  StatusBoard& status_;
  StopRequest& stop_;
  const std::shared_ptr<Ice::Communicator> communicator_;
  const std::shared_ptr<Ice::ObjectAdapter> adapter_;
};

/// Ice's name of the component's object adapter, under which its own keys stand.
std::string adapterName(const ComponentSpec& spec) {
  return spec.prefix + "Adapter";
}

struct ProcessKeys {
  std::string endpoints;
  LogLevel log_level = LogLevel::kInfo;
  bool end_with_parent = false;
};

ProcessKeys readProcessKeys(ConfigReader& root, const ComponentSpec& spec) {
  auto config = root.group(spec.prefix);
  ProcessKeys keys;
  keys.endpoints = config.text("Endpoints", spec.default_endpoints);
  if (keys.endpoints.empty())
    config.problem("Endpoints", "must be endpoints such as tcp -h 127.0.0.1 -p 9999");
  keys.log_level = config.choice("LogLevel", LogLevel::kInfo,
                                 {{"debug", LogLevel::kDebug},
                                  {"info", LogLevel::kInfo},
                                  {"warning", LogLevel::kWarning},
                                  {"error", LogLevel::kError}});
  keys.end_with_parent = config.boolean("EndWithParent", false);
  // Properties that Ice reads, and checks, itself: AdapterId, PublishedEndpoints, ThreadPool.Size ...
  root.known(adapterName(spec) + ".*");
  return keys;
}

struct Configured {
  std::unique_ptr<Component> component;
  Ice::CommunicatorHolder communicator;
};

/// Reads everything that can be wrong in a configuration, and throws it all together.
Configured configure(const ComponentSpec& spec, const Properties& properties, ConfigReader& config,
                     const ProcessKeys& keys, Logger& log) {
  // Of a file that cannot be read nothing else is known.
  if (!properties.readable()) properties.throwIfBad();
  Configured configured;
  std::vector<std::string> more;
  const auto collect = [&more](auto&& step) {
    try {
      step();
    } catch (const ConfigError& error) {
      more.insert(more.end(), error.problems().begin(), error.problems().end());
    }
  };
  collect([&] { configured.component = spec.configure(config); });
  auto problems = config.allProblems();
  const auto add = [&problems](const std::vector<Problem>& others) {
    problems.insert(problems.end(), others.begin(), others.end());
  };
  add(checkAdapterKeys(properties, adapterName(spec)));
  collect([&] {
    // With keys that Ice would only warn of, its defaults are good enough to look at proxies.
    const bool takes_keys =
        checkIceKeys(properties).empty() && checkAdapterKeys(properties, adapterName(spec)).empty();
    configured.communicator =
        Ice::CommunicatorHolder(makeCommunicator(takes_keys ? properties : Properties{}, log));
    add(checkProxies(config, properties, *configured.communicator.communicator()));
    add(checkEndpoints(spec.prefix + ".Endpoints", keys.endpoints, properties,
                       *configured.communicator.communicator()));
  });
  auto lines = problemLines(std::move(problems));
  lines.insert(lines.end(), more.begin(), more.end());
  if (!lines.empty()) throw ConfigError(lines);
  if (!configured.component) throw std::logic_error("configure() gave no component though nothing is wrong");
  return configured;
}

std::vector<Setting> effectiveConfiguration(const ConfigReader& config, const Properties& properties) {
  auto settings = config.effective();
  for (const auto& setting : iceDefaults()) {
    if (properties.find(setting.key) == nullptr) settings.push_back(setting);
  }
  for (const auto& [key, entry] : properties.entries()) {
    if (belongsToIce(key)) settings.push_back({key, entry.value, entry.origin.text()});
  }
  std::sort(settings.begin(), settings.end(),
            [](const Setting& a, const Setting& b) { return a.key < b.key; });
  return settings;
}

std::string configurationText(const std::vector<Setting>& settings) {
  std::string text = "configuration:";
  for (const auto& setting : settings) {
    text +=
        "\n" + setting.key + " = " + setting.value + (setting.origin.empty() ? "" : "   # " + setting.origin);
  }
  return text;
}

void printHelp(const ComponentSpec& spec) {
  const Properties none;
  ConfigReader config(none);
  readProcessKeys(config, spec);
  try {
    spec.configure(config);
  } catch (const ConfigError&) {
    // Required keys are missing, which is no concern of a listing.
  }
  std::cout << spec.name << ": " << spec.summary << "\n\n"
            << "usage: " << spec.name << " [--Ice.Config=FILE | FILE] [--Key=Value ...]\n"
            << "       " << spec.name << " --help | --version\n\n"
            << "Without a file the one named by the environment variable ICE_CONFIG is read.\n"
            << "Exit code: 0 after SIGINT or SIGTERM, 1 on a failure, 2 on a wrong configuration.\n\n"
            << "Keys and their defaults:\n";
  for (const auto& setting : config.effective())
    std::cout << "  " << setting.key << " = " << setting.value << "\n";
}

/// Stops what was started, however the start went, and in this order (STYLE 8).
class Ending {
 public:
  Ending(Component& component, ComponentHost& host) : component_(component), host_(host) {}
  ~Ending() {
    host_.status().stopping();
    host_.adapter()->deactivate();
    try {
      component_.stop();
    } catch (const std::exception& failure) {
      host_.log().error("while stopping: " + describeFailure(failure));
    }
    // Waits for the requests in flight, so that nobody works on what goes next.
    host_.communicator()->destroy();
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

 private:
  Component& component_;
  ComponentHost& host_;
};

/// Each connection is a descriptor: idle ones of strangers must not leave none for others.
void allowManyConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 65'536);
  setrlimit(RLIMIT_NOFILE, &limit);
}

void serveUntilStopped(const ComponentSpec& spec, Component& component, Host& host, StopRequest& stop) {
  const Ending ending(component, host);
  host.serve(spec.name + "/component", std::make_shared<ComponentServant>(host.status()));
  component.start(host);
  host.adapter()->activate();
  host.status().serving();
  std::cout << readyLine(spec.name, host.adapter()->getName(), publishedEndpoints(*host.adapter()))
            << std::endl;
  host.log().info("stopping: " + stop.wait([&host] { host.status().checkProgress(); }));
}

void runConfigured(const ComponentSpec& spec, const Properties& properties, Logger& log, StopRequest& stop) {
  ConfigReader config(properties);
  const auto keys = readProcessKeys(config, spec);
  log.setLowest(keys.log_level);
  auto [component, communicator] = configure(spec, properties, config, keys, log);
  allowManyConnections();
  if (keys.end_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);

  const auto settings = effectiveConfiguration(config, properties);
  StatusBoard status(spec.name, VISMEM_VERSION, log);
  status.setConfiguration(settings);
  const auto adapter = makeAdapter(*communicator.communicator(), adapterName(spec),
                                   spec.prefix + ".Endpoints", keys.endpoints);
  log.info(configurationText(settings));
  Host host(log, status, stop, communicator.communicator(), adapter);
  serveUntilStopped(spec, *component, host, stop);
  component.reset();
  stop.rethrowFailure();
}

}  // namespace

void ComponentHost::serve(const std::string& identity, const std::shared_ptr<Ice::Object>& servant) {
  adapter()->add(servant, Ice::stringToIdentity(identity));
}

void declareProcessKeys(ConfigReader& config, const ComponentSpec& spec) {
  readProcessKeys(config, spec);
}

int runComponent(int argc, char** argv, const ComponentSpec& spec) {
  StopRequest stop(spec.name);
  const Ice::CtrlCHandler signals([&](int number) {
    // Whoever asks twice does not want to wait for a clean end.
    if (!stop.request("signal " + std::to_string(number))) _exit(128 + number);
  });
  Logger log(spec.name);
  limitAllocations(kLargestAllocation);
  try {
    const char* environment_config = std::getenv("ICE_CONFIG");
    const auto line = parseCommandLine({argv + std::min(argc, 1), argv + argc},
                                       environment_config == nullptr ? "" : environment_config);
    switch (line.action) {
      case CommandLine::Action::kHelp:
        printHelp(spec);
        return kExitClean;
      case CommandLine::Action::kVersion:
        std::cout << spec.name << " " << VISMEM_VERSION << std::endl;
        return kExitClean;
      case CommandLine::Action::kRun:
        break;
    }
    runConfigured(spec, line.properties, log, stop);
    return kExitClean;
  } catch (const ConfigError& error) {
    std::cerr << error.what() << std::endl;
    return kExitConfiguration;
  } catch (const std::exception& failure) {
    log.error(describeFailure(failure));
  } catch (...) {
    log.error("something was thrown that is no std::exception");
  }
  return kExitFailure;
}

}  // namespace vismem
