#include "active_visual_memory/core/ground/floor_segment.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vismem {

void conditionOnFrameTilt(FloorSegment& segment, const Eigen::Matrix2d& P_frame_tilt, double per_frame_rad) {
  const double known = std::min(per_frame_rad, segment.pitch_sigma_rad);
  for (FloorEnd* end : {&segment.a, &segment.b}) {
    end->P += end->D.leftCols<2>() * P_frame_tilt * end->D.leftCols<2>().transpose() -
              known * known * end->D.rightCols<2>() * end->D.rightCols<2>().transpose();
  }
  segment.pitch_sigma_rad = std::sqrt((segment.pitch_sigma_rad - known) * (segment.pitch_sigma_rad + known));
}

bool cutToRange(FloorSegment& segment, const Eigen::Vector2d& below_camera, double range_m) {
  const auto inside = clipToDisc(segment.odom(), below_camera, range_m);
  if (!inside) return false;
  const FloorEnd from = segment.a;
  const FloorEnd to = segment.b;
  const auto cut = [&](FloorEnd& end, double at) {
    end.p = from.p + at * (to.p - from.p);
    end.D = from.D + at * (to.D - from.D);
    end.censored = true;
  };
  if (inside->first > 0.0) cut(segment.a, inside->first);
  if (inside->second < 1.0) cut(segment.b, inside->second);
  return true;
}

FloorSegment reversed(const FloorSegment& segment) {
  FloorSegment r = segment;
  std::swap(r.a, r.b);
  return r;
}

FloorSegment runningAlong(const Eigen::Vector2d& direction, const FloorSegment& segment) {
  return direction.dot(segment.b.p - segment.a.p) < 0.0 ? reversed(segment) : segment;
}

}  // namespace vismem
