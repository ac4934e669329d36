#include "support/application.h"

#include <csignal>
#include <sstream>
#include <thread>

#include "common/process/ice_setup.h"
#include "common/process/setup.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kAnswerWithin = 1000ms;

std::shared_ptr<Ice::Communicator> communicatorOf(Logger& log) {
  Properties properties;
  properties.set("Ice.RetryIntervals", "-1");
  properties.set("Ice.Override.CloseTimeout", "200");
  return makeCommunicator(properties, log);
}

/// Progress of a component's work: the totals of its rates.
std::int64_t workOf(const StatusReport& report) {
  for (const char* what : {"iterations", "estimates", "frames", "samples"}) {
    for (const auto& rate : report.rates) {
      if (rate.name == what) return rate.total;
    }
  }
  return -1;  // a component that counts nothing
}

std::string textOf(const std::optional<StatusReport>& report) {
  return report ? nameOf(report->state) + (report->reason.empty() ? "" : ": " + report->reason) : "no answer";
}

}  // namespace

Application::Application(const std::string& setup, int port_offset, ExtraArguments extra)
    : setup_(setup),
      port_offset_(port_offset),
      extra_(std::move(extra)),
      communicator_(communicatorOf(log_)) {
  for (const auto& component : componentsOfSetup(std::string(VISMEM_SOURCE_DIR) + "/cfg/" + setup)) {
    // Serves pages to browsers, has no peers, and starts only with a token: test/gui tries it.
    if (component.name == "gui_server") continue;
    names_.push_back(component.name);
    endpoints_[component.name] = shiftPorts(component.endpoints, port_offset);
  }
}

std::vector<std::string> Application::argumentsOf(const std::string& name) const {
  const std::string file = "cfg/" + setup_ + "/" + name + ".cfg";
  std::vector<std::string> arguments =
      portArguments(std::string(VISMEM_SOURCE_DIR) + "/" + file, port_offset_);
  arguments.insert(arguments.begin(), "--Ice.Config=" + file);
  const auto extra = extra_.find(name);
  if (extra != extra_.end()) arguments.insert(arguments.end(), extra->second.begin(), extra->second.end());
  return arguments;
}

testing::AssertionResult Application::start(const std::string& name) {
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  frozen_.erase(name);
  processes_[name] = std::make_unique<ComponentProcess>(name, argumentsOf(name), std::move(options));
  return processes_[name]->waitUntilReady();
}

testing::AssertionResult Application::startAll() {
  for (const auto& name : names_) {
    if (const auto started = start(name); !started) return started;
  }
  return testing::AssertionSuccess();
}

void Application::kill(const std::string& name) {
  process(name).signal(SIGKILL);
  process(name).waitForExit(kPatience);
  processes_.erase(name);
  frozen_.erase(name);
}

void Application::freeze(const std::string& name) {
  process(name).signal(SIGSTOP);
  frozen_[name] = true;
}

void Application::goOn(const std::string& name) {
  process(name).signal(SIGCONT);
  frozen_.erase(name);
}

std::string Application::proxy(const std::string& name, const std::string& identity) const {
  const std::string& endpoints = endpoints_.at(name);
  return identity + ":" + endpoints.substr(0, endpoints.find(':'));
}

std::optional<StatusReport> Application::status(const std::string& name) {
  return askStatus(ice(), {proxy(name, name + "/component")}, kAnswerWithin).front().report;
}

testing::AssertionResult Application::says(const std::string& name, RunState state, const std::string& reason,
                                           std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  std::optional<StatusReport> report;
  do {
    report = status(name);
    if (report && report->state == state && report->reason.find(reason) != std::string::npos) {
      return testing::AssertionSuccess();
    }
    std::this_thread::sleep_for(20ms);
  } while (Clock::now() < deadline);
  return testing::AssertionFailure() << name << " did not say " << nameOf(state) << ": " << reason
                                     << "; it says " << textOf(report);
}

std::optional<std::chrono::milliseconds> Application::waitUntilWhole(std::chrono::milliseconds patience) {
  const auto begin = Clock::now();
  std::vector<std::string> proxies;
  for (const auto& name : names_) proxies.push_back(proxy(name, name + "/component"));
  std::map<std::string, std::int64_t> first_work;
  do {
    const auto answers = askStatus(ice(), proxies, kAnswerWithin);
    why_.clear();
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto& report = answers[i].report;
      if (!report || report->state != RunState::kRunning) {
        why_ += names_[i] + " is " + textOf(report) + "; ";
        first_work.erase(names_[i]);
        continue;
      }
      const std::int64_t work = workOf(*report);
      const auto [known, is_new] = first_work.try_emplace(names_[i], work);
      // Once more than an image that was on its way already.
      if (work >= 0 && work < known->second + 2) why_ += names_[i] + " does not go on; ";
    }
    if (why_.empty()) return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
    std::this_thread::sleep_for(10ms);
  } while (Clock::now() - begin < patience);
  return std::nullopt;
}

std::string Application::logs() const {
  std::string text;
  for (const auto& [name, process] : processes_) {
    std::istringstream lines(process->error());
    std::deque<std::string> last;
    for (std::string line; std::getline(lines, line);) {
      last.push_back(line);
      if (last.size() > 15) last.pop_front();
    }
    for (const auto& line : last) text += line + "\n";
  }
  return text;
}

}  // namespace vismem
