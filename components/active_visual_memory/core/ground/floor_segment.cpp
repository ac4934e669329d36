#include "active_visual_memory/core/ground/floor_segment.h"

#include <algorithm>
#include <cmath>

namespace vismem {

void conditionOnFrameTilt(FloorSegment& segment, const Eigen::Matrix2d& P_frame_tilt, double per_frame_rad) {
  const double known = std::min(per_frame_rad, segment.pitch_sigma_rad);
  const auto replace = [&](Eigen::Matrix2d& P, const TiltJacobian& D) {
    P += D.leftCols<2>() * P_frame_tilt * D.leftCols<2>().transpose() -
         known * known * D.rightCols<2>() * D.rightCols<2>().transpose();
  };
  replace(segment.P_a, segment.D_a);
  replace(segment.P_b, segment.D_b);
  segment.pitch_sigma_rad = std::sqrt((segment.pitch_sigma_rad - known) * (segment.pitch_sigma_rad + known));
}

bool cutToRange(FloorSegment& segment, const Eigen::Vector2d& below_camera, double range_m) {
  const auto inside = clipToDisc(segment.odom, below_camera, range_m);
  if (!inside) return false;
  const auto [from, to] = *inside;
  const Segment2 whole = segment.odom;
  const Eigen::Vector2d along = whole.b - whole.a;
  const TiltJacobian D_a = segment.D_a;
  const TiltJacobian D_along = segment.D_b - segment.D_a;
  if (from > 0.0) {
    segment.odom.a = whole.a + from * along;
    segment.D_a = D_a + from * D_along;
    segment.censored_a = true;
  }
  if (to < 1.0) {
    segment.odom.b = whole.a + to * along;
    segment.D_b = D_a + to * D_along;
    segment.censored_b = true;
  }
  return true;
}

FloorSegment reversed(const FloorSegment& segment) {
  FloorSegment r = segment;
  std::swap(r.odom.a, r.odom.b);
  std::swap(r.P_a, r.P_b);
  std::swap(r.D_a, r.D_b);
  std::swap(r.censored_a, r.censored_b);
  return r;
}

}  // namespace vismem
