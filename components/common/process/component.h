/// @file The life of a process of the application: command line, configuration, Ice, serving, stopping.
/// Implements C2. See C3.
// clang-format off
/// @code
///   int main(int argc, char** argv) {
///     vismem::ComponentSpec spec;
///     spec.name = "localization";
///     spec.prefix = "Localization";
///     spec.summary = "Estimates the pose of the robot on the map.";
///     spec.default_endpoints = "tcp -h 127.0.0.1 -p 9971";
///     spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11005";
///     spec.configure = [](vismem::ConfigReader& config) -> std::unique_ptr<vismem::Component> {
///       const auto settings = vismem::readLocalizationConfig(config);
///       // Before maps or devices are opened:
///       if (!config.good()) return nullptr;
///       return std::make_unique<vismem::LocalizationComponent>(settings);
///     };
///     return vismem::runComponent(argc, argv, spec);
///   }
/// @endcode
// clang-format on
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/peer.h"

namespace vismem {

class ComponentHost;
class Logger;
class ParameterTable;
class StatusBoard;

/// The component of a process, from start to stop. Called by the main thread only.
class Component {
 public:
  virtual ~Component() = default;
  /// Adds servants and peers, starts loops and drivers. Must not wait for a peer: components start in any
  /// order (see C3). The adapter serves once this has returned. Anything thrown ends the process:
  /// ConfigError with code 2, others with 1. stop() is called after a failed start too.
  virtual void start(ComponentHost& host) = 0;
  /// The adapter takes no more requests. Ends loops (interrupting their waits), answers pending AMD requests,
  /// stops drivers. The communicator still works, so that last commands (stop the motors) can be sent.
  virtual void stop() = 0;
};

/// Services of runComponent for the component, from start() until the return of stop(). Thread-safe.
class ComponentHost {
 public:
  virtual ~ComponentHost() = default;

  virtual Logger& log() = 0;
  virtual StatusBoard& status() = 0;
  /// Values that clients may change while the component runs; add them in start().
  virtual ParameterTable& parameters() = 0;
  virtual const std::shared_ptr<Ice::Communicator>& communicator() = 0;
  virtual const std::shared_ptr<Ice::ObjectAdapter>& adapter() = 0;

  /// Ends the process as SIGTERM would, with exit code 0. Returns at once.
  virtual void requestStop() = 0;
  /// Ends the process with exit code 1 and the message of the exception of a loop. Returns at once.
  virtual void fail(std::exception_ptr failure) = 0;

  /// Wraps the work of a thread: an exception ends the process by fail() with a message. Otherwise the
  /// component would continue without that thread.
  template <typename Work>
  auto guarded(Work work) {
    return [this, work = std::move(work)](auto&&... arguments) {
      try {
        work(std::forward<decltype(arguments)>(arguments)...);
      } catch (...) {
        fail(std::current_exception());
      }
    };
  }

  /// Serves an object under its own identity and in all faces (docs/remote-access.md).
  /// @param identity without the robot's name: "cameraA".
  virtual void serve(const std::string& identity, const std::shared_ptr<Ice::Object>& servant) = 0;

  /// @param name        for people: "Camera".
  /// @param proxy_text value of the key that names the peer; not empty. Keys that end in "Proxy" are
  /// well-formed here.
  template <typename Prx>
  std::shared_ptr<RemotePeer<Prx>> peer(const std::string& name, const std::string& proxy_text) {
    return std::make_shared<RemotePeer<Prx>>(name, communicator()->stringToProxy(proxy_text), status(),
                                             log());
  }
};

struct ComponentSpec {
  /// Name of the program, in the log and the ready line; its status is served as NAME/component.
  std::string name;
  /// Prefix of the keys that runComponent reads itself: PREFIX.Endpoints, PREFIX.WebEndpoints,
  /// PREFIX.PlainRemote, PREFIX.LogLevel, PREFIX.EndWithParent. The adapters are called PREFIXAdapter and
  /// PREFIXWebAdapter.
  std::string prefix;
  /// One sentence for --help.
  std::string summary;
  /// Default of PREFIX.Endpoints.
  std::string default_endpoints;
  /// Default of PREFIX.WebEndpoints, which serves web pages once Robot.Token or Robot.ViewToken is set.
  std::string default_web_endpoints;
  /// Reads all keys of the component and makes it, without opening devices or contacting peers. The reader
  /// has no prefix: use config.group("Localization"). May throw ConfigError (maps, worlds), which is reported
  /// together with the problems of the reader. May return nullptr if the reader is not good().
  std::function<std::unique_ptr<Component>(ConfigReader& config)> configure;
};

/// Exit codes of every component.
inline constexpr int kExitClean = 0;
/// Port in use, a device that cannot be opened, any other exception.
inline constexpr int kExitFailure = 1;
/// Wrong command line or configuration; all problems are on stderr, one a line.
inline constexpr int kExitConfiguration = 2;

/// Maximum duration of a stop: longer than every bounded wait (a last command to a frozen peer, closing
/// connections). After it the process ends with kExitFailure, even if a thread hangs.
inline constexpr std::chrono::seconds kStopWithin{4};

/// Runs a component until SIGINT, SIGTERM, requestStop or fail. Call it first in main, before any other
/// thread starts. Command line: [FILE | --Ice.Config=FILE] [--Key=Value ...] | --help | --list-keys |
/// --version; without a file, the one of the environment variable ICE_CONFIG is read. When it serves, it
/// prints one line on stdout, "NAME ready: PREFIXAdapter=tcp -h 127.0.0.1 -p 9971" (see ready_line.h), with
/// the actual port for -p 0.
int runComponent(int argc, char** argv, const ComponentSpec& spec);

}  // namespace vismem
