/// @file What a server's status learns of one camera. No Ice.
#pragma once

#include <string>

#include "common/process/status.h"
#include "common/robot/ports.h"

namespace vismem {

/// Counts frames under the camera's name, measures how old they are when they come, keeps lost pictures among
/// the errors, and makes a fault of a camera that is away, at its end or silent. *Single-threaded* (owner:
/// who reads the camera); the board must outlive it.
class CameraHealth {
 public:
  /// @param rate_hz nominal; 0: unknown. A camera is silent when nothing came for five periods, at least 2 s.
  CameraHealth(StatusBoard& status, std::string camera, double rate_hz);

  /// @param host_us the host's real time. @param lens_problem of PreparedCamera.
  void heard(const FrameResult& result, const std::string& lens_problem, SteadyTime now, StampUs host_us);

 private:
  StatusBoard& status_;
  const std::string camera_;
  const double patience_s_;
  SteadyTime last_{};
};

}  // namespace vismem
