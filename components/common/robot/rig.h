/// @file The rig of a robot: where its pan-tilt unit and camera sit and how far the joints turn. Pure. See
/// G1.
#pragma once

#include <algorithm>

#include "common/geometry/camera.h"

namespace vismem {

/// One value for all who point the camera. Invariant: each minimum is less than its maximum. *Value.*
struct Rig {
  CameraMount mount;
  double min_pan_rad = -2.775;  ///< joint limits; +-159 degrees by default, > 0 looks left
  double max_pan_rad = 2.775;
  double min_tilt_rad = -0.541;  ///< +-31 degrees by default, > 0 looks up
  double max_tilt_rad = 0.541;

  /// The nearest angles within the joint limits [rad].
  PanTilt clamped(const PanTilt& angles) const {
    return {std::clamp(angles.pan_rad, min_pan_rad, max_pan_rad),
            std::clamp(angles.tilt_rad, min_tilt_rad, max_tilt_rad)};
  }
};

}  // namespace vismem
