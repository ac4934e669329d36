/// @file The field of view of a camera over the floor, as the figures draw it. Pure.
#pragma once

namespace vismem {

/// The visible floor: a sector from the robot.
struct ViewCone {
  double heading_rad = 0.0;  ///< of the optical axis in world
  double opening_rad = 0.0;  ///< the horizontal field of view
  double range_m = 2.0;
};

}  // namespace vismem
