/// @file What the benchmark measures: a simulated robot over tcp and TLS, and the gateway of deploy/gateway
/// before it, as processes of their own.
#pragma once

#include <Ice/Ice.h>
#include <avm/camera.h>
#include <avm/simulation.h>

#include <memory>
#include <string>

#include "remote_access/gateway.h"
#include "support/component_process.h"
#include "support/temporary_folder.h"

namespace vismem {

class Site {
 public:
  /// Waits until all serve. @param width of images [px], which are 4:3. @param rate_hz of the camera.
  Site(int width, double rate_hz);

  /// "tcp -h 127.0.0.1 -p 41233", as the gateway reaches the robot.
  std::string plainEndpoint() const { return endpoint("tcp"); }
  std::shared_ptr<avm::CameraPrx> camera(const std::string& transport) const;
  /// Stops and continues simulated time: no images are rendered meanwhile.
  void pause(bool paused) const;

  const test::Gateway& gateway() const { return *gateway_; }
  pid_t robot() const { return robot_->pid(); }

 private:
  std::string endpoint(const std::string& transport) const;

  TemporaryFolder certificates_;
  std::unique_ptr<ComponentProcess> robot_;
  std::unique_ptr<test::Gateway> gateway_;
  Ice::CommunicatorHolder communicator_;
};

}  // namespace vismem
