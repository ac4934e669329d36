/// @file The field of view of a camera over the floor, as the figures draw it. Pure.
#pragma once

#include <cmath>

#include "common/geometry/pose.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// The visible floor: a sector from the robot.
struct ViewCone {
  double heading_rad = 0.0;  ///< of the optical axis in world
  double opening_rad = 0.0;  ///< the horizontal field of view
  double range_m = 0.0;
};

/// The view of an image's camera.
inline ViewCone viewOf(const Pose2& T_world_robot, const ImageAnalysis& analysis, double range_m) {
  const Eigen::Vector3d axis = (toPose3(T_world_robot) * analysis.T_robot_camera).linear().col(2);
  const double opening = 2.0 * std::atan2(0.5 * analysis.intrinsics.width, analysis.intrinsics.fx);
  return {std::atan2(axis.y(), axis.x()), opening, range_m};
}

}  // namespace vismem
