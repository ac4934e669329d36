/// @file A whole setup (cfg/SETUP) as processes that a test kills, freezes, continues and starts again.
#pragma once

#include <Ice/Ice.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/process/log.h"
#include "common/process/status_client.h"
#include "support/component_process.h"

namespace vismem {

/// A component's own arguments, over those of its configuration: {"simulator", {"--Simulator.Seed=3"}}.
using ExtraArguments = std::map<std::string, std::vector<std::string>>;

/// Runs the components of a setup on shifted ports, each as `NAME --Ice.Config=cfg/SETUP/NAME.cfg` and what
/// moves its ports. *Single-threaded.*
class Application {
 public:
  /// Starts nothing yet.
  Application(const std::string& setup, int port_offset, ExtraArguments extra = {});

  const std::vector<std::string>& names() const { return names_; }
  ComponentProcess& process(const std::string& name) { return *processes_.at(name); }
  bool runs(const std::string& name) const { return processes_.count(name) > 0; }
  bool isFrozen(const std::string& name) const { return frozen_.count(name) > 0; }

  /// Starts a component and waits until it serves.
  testing::AssertionResult start(const std::string& name);
  testing::AssertionResult startAll();
  void kill(const std::string& name);
  void freeze(const std::string& name);
  void goOn(const std::string& name);

  /// The present status of a component; empty without an answer within 1 s.
  std::optional<StatusReport> status(const std::string& name);
  /// Waits until a component gives this state with a reason that holds the text.
  testing::AssertionResult says(const std::string& name, RunState state, const std::string& reason,
                                std::chrono::milliseconds patience);

  /// Waits until the application is whole: every component is running and its work goes on (images,
  /// iterations of the memory, poses).
  /// @return the elapsed time; empty at the deadline, with the missing part in `why()`.
  std::optional<std::chrono::milliseconds> waitUntilWhole(std::chrono::milliseconds patience);
  const std::string& why() const { return why_; }

  /// A proxy to an object of a component, also while it is away: "Motors:tcp -h 127.0.0.1 -p 15990".
  std::string proxy(const std::string& name, const std::string& identity) const;
  const std::string& endpoints(const std::string& name) const { return endpoints_.at(name); }
  Ice::Communicator& ice() { return *communicator_.communicator(); }
  /// The last lines of all logs, for messages of failures.
  std::string logs() const;

 private:
  std::vector<std::string> argumentsOf(const std::string& name) const;

  const std::string setup_;
  const int port_offset_;
  const ExtraArguments extra_;
  std::vector<std::string> names_;
  std::map<std::string, std::string> endpoints_;
  std::map<std::string, std::unique_ptr<ComponentProcess>> processes_;
  std::map<std::string, bool> frozen_;
  std::string why_;
  Logger log_{"test", LogLevel::kError};
  Ice::CommunicatorHolder communicator_;
};

}  // namespace vismem
