#include "active_visual_memory/core/ground/edge_blur.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {

double trueHalfWidth(double x, double sigma_px) {
  if (sigma_px <= 0.0) return x;
  double h = x;
  constexpr int kIterations = 25;
  for (int i = 0; i < kIterations; ++i) h = x * std::tanh(x * h / (sigma_px * sigma_px));
  return h;
}

std::vector<ImageSegment> correctEdgeBlur(const std::vector<ImageSegment>& segments,
                                          const EdgeBlurParams& params) {
  std::vector<ImageSegment> corrected = segments;
  if (params.sigma_px <= 0.0) return corrected;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment2& px = segments[i].px;
    const Eigen::Vector2d along = (px.b - px.a).normalized();
    const Eigen::Vector2d normal = turned90(along);
    const double length = px.length();
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t j = 0; j < segments.size(); ++j) {
      if (j == i) continue;
      const Segment2& other = segments[j].px;
      if ((other.b - other.a).dot(along) >= 0.0) continue;  // of one polarity
      if (lineAngleDifference(px.direction(), other.direction()) > params.max_angle_rad) continue;
      const double ta = along.dot(other.a - px.a);
      const double tb = along.dot(other.b - px.a);
      const double low = std::max(0.0, std::min(ta, tb));
      const double high = std::min(length, std::max(ta, tb));
      if (high - low < params.min_overlap * std::min(length, other.length())) continue;
      // Distance at the middle of the overlap.
      const double t = 0.5 * (low + high);
      const double share = (t - ta) / (tb - ta);
      const double distance = normal.dot(other.a + share * (other.b - other.a) - px.a);
      if (std::abs(distance) < std::abs(nearest)) nearest = distance;
    }
    if (std::abs(nearest) > params.max_width_px) continue;
    const double half = 0.5 * std::abs(nearest);
    const double inward = half - trueHalfWidth(half, params.sigma_px);
    const Eigen::Vector2d shift = std::copysign(inward, nearest) * normal;
    corrected[i].px.a += shift;
    corrected[i].px.b += shift;
  }
  return corrected;
}

}  // namespace vismem
