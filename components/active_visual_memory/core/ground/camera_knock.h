/// @file Whether the camera still looks as it was calibrated: the daily check without a board. Pure.
/// See B5.
#pragma once

#include <string>

#include "active_visual_memory/core/ground/camera_tilt.h"

namespace vismem {

/// How far the camera looks off its configured direction.
struct CameraKnock {
  double angle_rad = 0.0;  ///< of elevation and roll together, at pan and tilt 0
  double sigma_rad = 0.0;  ///< its standard deviation
};

/// Of the sums of mount and camera error, which are known better than the parts.
CameraKnock knockOf(const CameraTilt& camera_tilt, const CameraTiltCovariance& P);

/// Says once that the camera was knocked, and once that it is no longer. *Single-threaded.*
class KnockAlarm {
 public:
  /// @param calibrated_rad standard deviation of the calibrated direction; 0: never calibrated, no alarm.
  explicit KnockAlarm(double calibrated_rad) : calibrated_rad_(calibrated_rad) {}

  /// @return what to say now; empty for nothing new. The alarm begins beyond 3 standard deviations and ends
  /// below 2.
  std::string update(const CameraKnock& knock);
  bool isOn() const { return on_; }

 private:
  double calibrated_rad_;
  bool on_ = false;
};

}  // namespace vismem
