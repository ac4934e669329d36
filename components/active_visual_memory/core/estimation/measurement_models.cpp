#include "active_visual_memory/core/estimation/measurement_models.h"

#include <algorithm>
#include <cmath>

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

void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                      const TiltView& view, double slack_m, double noise, double end_inflation,
                      double max_end_shift_m, std::vector<LineResidual>& residuals) {
  const Eigen::Vector2d n = line.normal();
  const Eigen::Vector2d u = line.along();
  const FloorSegment observed = runningAlong(u, piece);
  const double slack = slack_m * slack_m;
  const double end_noise = noise * end_inflation * end_inflation;
  const auto variance = [&](const Eigen::Vector2d& direction, const FloorEnd& seen) {
    return ownVariance(direction, seen, observed.pitch_sigma_rad);
  };
  for (const bool at_b : {false, true}) {
    const FloorEnd& seen = observed.end(at_b);
    const ExtentEnd& known = line.end(at_b);
    const double off = line.offsetOf(seen.p);
    const TiltJacobianRow across = n.transpose() * view.derivativeAt(seen.p - off * n);
    residuals.push_back({seen.p, n, off, noise * (variance(n, seen) + slack), across, across.head<2>(), id});
    const double gap = line.tOf(seen.p) - known.t_m;
    if (seen.censored || known.censored || std::abs(gap) > max_end_shift_m) continue;
    // The extent is not in the filter.
    const TiltJacobianRow far = u.transpose() * view.derivativeAt(line.pointAt(known.t_m));
    residuals.push_back({seen.p, u, gap, end_noise * (variance(u, seen) + known.variance_m2 + slack),
                         far - known.d_tilt, far.head<2>(), 0});
  }
}

}  // namespace vismem
