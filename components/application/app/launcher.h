/// @file The components of a setup as child processes.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "application/app/options.h"
#include "common/process/child_process.h"

namespace vismem {

/// One program with its configuration and the keys that this run overrides.
struct ComponentCommand {
  std::string name;  ///< of the program, and in its ready line
  std::vector<std::string> arguments;
};

/// The commands of a setup: `NAME --Ice.Config=cfg/SETUP/NAME.cfg --Key=Value ...`.
/// @throws ConfigError when a configuration cannot be read.
std::vector<ComponentCommand> commandsOf(const RunOptions& options);

/// Where the page of a run is: "http://127.0.0.1:8770/"; empty without one.
/// @throws ConfigError when the configuration of its server cannot be read.
std::string pageAddressOf(const RunOptions& options);

/// What the log of a component that failed ends with, without entries of level INFO; each line begins anew.
std::string lastWords(const std::string& log);

/// The palette of this run: beside the map, else of the memory's configuration; empty for none.
std::filesystem::path paletteOf(const RunOptions& options);

/// A component ended or did not become ready; what() holds its last lines.
class ComponentFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs the components. They end with this object. *Single-threaded*; the constructing thread must outlive it
/// (see ChildProcess).
class Launcher {
 public:
  Launcher(const RunOptions& options, const std::vector<ComponentCommand>& commands);
  ~Launcher() { stopAll(); }
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// @param interrupted polled; true ends the waiting.
  /// @return false when interrupted.
  /// @throws ComponentFailure when a component ends or is not ready within the time.
  bool waitUntilReady(std::chrono::seconds timeout, const std::function<bool()>& interrupted);
  /// @throws ComponentFailure when a component has ended.
  void checkAlive() const;
  /// A proxy to an object of a component: "cameraA:tcp -h 127.0.0.1 -p 9999".
  std::string proxy(const std::string& component, const std::string& identity) const;
  /// Stops all in the reverse order of their start; kills a process that has not ended after 5 s.
  void stopAll();

 private:
  struct Child {
    std::string name;
    std::unique_ptr<ChildProcess> process;
  };
  [[noreturn]] static void fail(const Child& child, const std::string& what);

  std::vector<Child> children_;
};

}  // namespace vismem
