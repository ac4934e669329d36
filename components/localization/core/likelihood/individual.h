/// @file A pose with its health. Pure. See L1.
#pragma once

#include "common/geometry/pose.h"

namespace vismem {

/// A pose where the robot may be, with its health in 0..1: an explorer, or a member of a race in chapter
/// mode.
struct Individual {
  Pose2 T_world_robot;
  double health = 0.0;
  bool is_rated = false;  ///< chapter mode: `health` is that of the last observation
};

}  // namespace vismem
