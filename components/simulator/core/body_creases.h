/// @file The creases and borders of a body's faces. Pure.
#pragma once

#include <vector>

#include "common/geometry/segment.h"
#include "simulator/core/world.h"

namespace vismem {

/// Creases in the coordinates that `T` maps the body's to [m]. Corners nearer than 0.1 mm are one. The order
/// depends on positions only.
/// @param min_angle_rad smallest angle between the faces of a crease; round bodies have smaller ones [rad].
std::vector<Segment3> creasesOf(const WorldBody& body, const Pose3& T, double min_angle_rad);

}  // namespace vismem
