/// @file The lines where the faces of a body meet at an angle, or end. Pure.
#pragma once

#include <vector>

#include "common/geometry/segment.h"
#include "simulator/core/world.h"

namespace vismem {

/// In the coordinates that `T` leads to from the body's [m]. Corners nearer than 0.1 mm are one. The order
/// depends on places only.
/// @param min_angle_rad faces that meet at a smaller angle make none (round bodies).
std::vector<Segment3> creasesOf(const WorldBody& body, const Pose3& T, double min_angle_rad);

}  // namespace vismem
