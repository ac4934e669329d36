#include "active_visual_memory/core/memory/edge_corner.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/plane.h"

namespace vismem {

CornerEdge cornerEdge(MemorySegment& published, const MemoryElement& element) {
  const Segment2 line = published.odom.floor();
  return {&published, &element, line, (line.b - line.a).normalized()};
}

double endReach(const ExtentEnd& end, const CornerParams& params) {
  return std::min(params.most_reach_m, params.reach_m + params.reach_sigmas * std::sqrt(end.best_m2));
}

bool findCorner(const CornerEdge& one, const CornerEdge& other, const CornerParams& params,
                EdgeCorner& corner) {
  if ((one.line.b - other.line.a).norm() > 2.0 * params.most_reach_m) return false;
  if (one.element->line.endB().censored || other.element->line.endA().censored) return false;
  const double cross = cross2(one.along, other.along);
  if (std::abs(cross) < std::sin(params.min_angle_rad)) return false;
  const Eigen::Vector2d between = other.line.a - one.line.b;
  const double outward_one = cross2(between, other.along) / cross;
  const double outward_other = cross2(between, one.along) / cross;
  if (std::abs(outward_one) > endReach(one.element->line.endB(), params) ||
      std::abs(outward_other) > endReach(other.element->line.endA(), params)) {
    return false;
  }
  corner.place = one.line.b + outward_one * one.along;
  corner.distance_m = std::abs(outward_one) + std::abs(outward_other);
  return true;
}

}  // namespace vismem
