#include "active_visual_memory/core/estimation/measurement_models.h"

#include <algorithm>

namespace vismem {
namespace {

/// Variance of an end along a direction without the contribution of camera pitch and roll, which are common
/// to the image and part of the state [m^2].
double ownVariance(const Eigen::Vector2d& direction, const FloorEnd& end, double pitch_sigma_rad) {
  return std::max(
      0.0, end.varianceAlong(direction) - pitch_sigma_rad * pitch_sigma_rad *
                                              (direction.transpose() * end.D.rightCols<2>()).squaredNorm());
}

}  // namespace

void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& observed,
                      const TiltView& view, double slack_m, double noise,
                      std::vector<LineResidual>& residuals) {
  const Eigen::Vector2d n = line.normal();
  for (const bool at_b : {false, true}) {
    const FloorEnd& seen = observed.end(at_b);
    const double off = line.offsetOf(seen.p);
    const double variance = ownVariance(n, seen, observed.pitch_sigma_rad) + slack_m * slack_m;
    const TiltJacobianRow across = n.transpose() * view.derivativeAt(seen.p - off * n);
    residuals.push_back({seen.p, n, off, noise * variance, across, across.head<2>(), id});
  }
}

}  // namespace vismem
