/// @file The life of a process of the application: command line, configuration, Ice, serving, stopping.
///
///   int main(int argc, char** argv) {
///     vismem::ComponentSpec spec;
///     spec.name = "localization";
///     spec.prefix = "Localization";
///     spec.summary = "Tells where the robot is.";
///     spec.default_endpoints = "tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005";
///     spec.configure = [](vismem::ConfigReader& config) -> std::unique_ptr<vismem::Component> {
///       const auto settings = vismem::readLocalizationConfig(config);  //
///       config.group("Localization").real(...) if (!config.good()) return nullptr; // before maps or devices
///       are opened return std::make_unique<vismem::LocalizationComponent>(settings);
///     };
///     return vismem::runComponent(argc, argv, spec);
///   }
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
class StatusBoard;

/// What a component does between the start and the end of its process. Called by the main thread only.
class Component {
 public:
  virtual ~Component() = default;
  /// Adds servants and peers, starts loops and drivers. Must not wait for a peer: components come up in any
  /// order (SPEC C3). The adapter serves once this has returned. Anything thrown ends the process:
  /// ConfigError with code 2, others with 1. stop() is called after a failed start too.
  virtual void start(ComponentHost& host) = 0;
  /// The adapter takes no more requests. Ends loops (interrupting their waits), answers pending AMD requests,
  /// stops drivers. The communicator still works, so that last commands (stop the motors) can be sent.
  virtual void stop() = 0;
};

/// What runComponent offers to the component, from start() until stop() has returned. Thread-safe.
class ComponentHost {
 public:
  virtual ~ComponentHost() = default;

  virtual Logger& log() = 0;
  virtual StatusBoard& status() = 0;
  virtual const std::shared_ptr<Ice::Communicator>& communicator() = 0;
  virtual const std::shared_ptr<Ice::ObjectAdapter>& adapter() = 0;

  /// Ends the process as SIGTERM would, with exit code 0. Returns at once.
  virtual void requestStop() = 0;
  /// Ends the process with the message of what a loop threw and exit code 1. Returns at once.
  virtual void fail(std::exception_ptr failure) = 0;

  /// Wraps the work of a thread: what it throws ends the process by fail(), loudly, instead of leaving a
  /// component that lives on without that thread.
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

  /// Serves an object. @param identity "cameraA", or "category/name".
  void serve(const std::string& identity, const std::shared_ptr<Ice::Object>& servant);

  /// @param name        for people: "Camera".
  /// @param proxy_text  value of the key that names the peer; not empty. Keys that end in "Proxy" are known
  /// to be
  ///                    well-formed here.
  template <typename Prx>
  std::shared_ptr<RemotePeer<Prx>> peer(const std::string& name, const std::string& proxy_text) {
    return std::make_shared<RemotePeer<Prx>>(name, communicator()->stringToProxy(proxy_text), status(),
                                             log());
  }
};

struct ComponentSpec {
  /// Of the program, in the log and the ready line; its status is served as NAME/component.
  std::string name;
  /// Of the keys that runComponent reads itself: PREFIX.Endpoints, PREFIX.LogLevel, PREFIX.EndWithParent.
  /// The adapter is called PREFIXServer.
  std::string prefix;
  /// One sentence for --help.
  std::string summary;
  /// Where it serves unless PREFIX.Endpoints says otherwise.
  std::string default_endpoints;
  /// Reads all keys of the component and makes it, opening no device and asking no peer. The reader has no
  /// prefix: take config.group("Localization"). May throw ConfigError (maps, worlds); it is reported together
  /// with what the reader has found. May return nullptr if the reader is not good().
  std::function<std::unique_ptr<Component>(ConfigReader& config)> configure;
};

/// Exit codes of every component.
inline constexpr int kExitClean = 0;
/// Port in use, a device that cannot be opened, anything thrown.
inline constexpr int kExitFailure = 1;
/// Wrong command line or configuration; all problems are on stderr, one a line.
inline constexpr int kExitConfiguration = 2;

/// How long a component may take to end once it was asked to: longer than every wait that it has by rights (a
/// last command to a frozen peer, closing connections). Whatever hangs then, the process ends with
/// kExitFailure.
inline constexpr std::chrono::seconds kStopWithin{4};

/// Runs a component until SIGINT, SIGTERM, requestStop or fail. Call it first in main: it must be there
/// before any other thread. Command line: [FILE | --Ice.Config=FILE] [--Key=Value ...] | --help | --version;
/// without a file the one of the environment variable ICE_CONFIG is read. Once it serves it prints one line
/// on stdout, "NAME ready: PREFIXAdapter=tcp -h 127.0.0.1 -p 9971" (see ready_line.h), with the real port
/// where -p 0 was asked.
int runComponent(int argc, char** argv, const ComponentSpec& spec);

/// Declares the keys that runComponent itself reads, for tests that load a configuration without running it.
void declareProcessKeys(ConfigReader& config, const ComponentSpec& spec);

}  // namespace vismem
