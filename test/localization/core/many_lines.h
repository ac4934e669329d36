/// @file A large map of lines, and the nearest of them by exhaustive search.
#pragma once

#include <algorithm>
#include <limits>
#include <numbers>

#include "common/geometry/angles.h"
#include "localization/core/map/map_index.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// Lines all over the floor; those of the second label stand among posts, of which only the feet are there.
inline SegmentMap manyLines(RandomEngine& engine) {
  SegmentMap map;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d a(uniform(engine, 0, 100), uniform(engine, 0, 100), 0.0);
    const Eigen::Vector3d way(uniform(engine, -4, 4), uniform(engine, -4, 4), 0.0);
    const bool is_post = i % 7 == 0;
    map.segments.push_back({{a, is_post ? Eigen::Vector3d(a + 2.0 * Eigen::Vector3d::UnitZ()) : a + way},
                            is_post || i % 3 == 0 ? "door" : "skirting",
                            0.0});
  }
  return map;
}

/// Distance to the nearest part of the label on the floor whose direction is within an angle.
inline double exhaustiveDistance(const MapIndex& index, int label, const Eigen::Vector2d& p,
                                 double direction_rad = 0.0, double within_rad = std::numbers::pi) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment2& line : index.floor(label)) {
    if (within_rad < std::numbers::pi && lineAngleDifference(line.direction(), direction_rad) > within_rad) {
      continue;
    }
    nearest_m = std::min(nearest_m, distanceToSegment(p, line));
  }
  return nearest_m;
}

}  // namespace vismem
