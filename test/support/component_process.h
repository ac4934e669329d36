/// @file A component of the application as a child process, for component and system tests.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/process/child_process.h"
#include "common/process/ready_line.h"
#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/ready_port.h"

namespace vismem {

/// A program of the build with its arguments. Ask for ephemeral ports, so that tests run side by side:
///
///   ComponentProcess simulator("simulator", {"--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"});
///   ASSERT_TRUE(simulator.waitUntilReady());
///   ComponentProcess memory("active_visual_memory", {"--...Camera.Proxy=" + simulator.proxy("cameraA"),
///   ...});
class ComponentProcess : public ChildProcess {
 public:
  ComponentProcess(const std::string& name, std::vector<std::string> arguments, Options options = {})
      : ChildProcess(commandOf(name, std::move(arguments)), std::move(options)), name_(name) {}

  /// @return whether it serves; if not, says what it wrote.
  testing::AssertionResult waitUntilReady() const {
    if (readyLine()) return testing::AssertionSuccess();
    return testing::AssertionFailure() << name_ << " is not ready; it wrote:\n" << out() << error();
  }
  /// The ready line, waited for; empty if the component ended before.
  std::optional<std::string> readyLine() const { return waitForLine(name_ + " ready: ", kPatience); }

  /// @return the port it serves at; 0 if it does not become ready or has no such endpoint.
  int port(const std::string& protocol = "tcp") const {
    const auto line = readyLine();
    return line ? readyPort(*line, protocol).value_or(0) : 0;
  }
  /// @return a proxy to one of its objects: "cameraA:tcp -h 127.0.0.1 -p 41233".
  std::string proxy(const std::string& identity) const {
    const auto line = readyLine();
    return identity + ":" + (line ? readyEndpoints(*line).value_or("") : "");
  }
  /// @return a proxy to its avm::Component.
  std::string statusProxy() const { return proxy(name_ + "/component"); }

 private:
  static std::vector<std::string> commandOf(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), std::string(VISMEM_BIN_DIR) + "/" + name);
    return arguments;
  }

  const std::string name_;
};

/// Starts a program in the source tree, where configurations name their files, and waits until it serves.
inline std::unique_ptr<ComponentProcess> startComponent(const std::string& name,
                                                        std::vector<std::string> arguments) {
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  auto process = std::make_unique<ComponentProcess>(name, std::move(arguments), std::move(options));
  EXPECT_TRUE(process->waitUntilReady());
  return process;
}

}  // namespace vismem
