/// @file Health of one camera in the status of its server. No Ice.
#pragma once

#include <string>

#include "common/process/status.h"
#include "common/robot/ports.h"

namespace vismem {

/// Counts frames under the camera's name, measures their age at arrival and reports lost images as errors. A
/// camera that is away, at its end or silent is a fault. *Single-threaded* (owner: the reader of the camera);
/// the board must outlive it.
class CameraHealth {
 public:
  /// @param rate_hz nominal rate [Hz]; 0: unknown. A camera is silent after five periods without a frame, at
  /// least 2 s.
  CameraHealth(StatusBoard& status, std::string camera, double rate_hz);

  /// @param host_us the host's real time [us].
  /// @param lens_problem from PreparedCamera::lensProblem.
  void heard(const FrameResult& result, const std::string& lens_problem, SteadyTime now, StampUs host_us);

 private:
  StatusBoard& status_;
  const std::string camera_;
  const double patience_s_;
  SteadyTime last_{};
};

}  // namespace vismem
