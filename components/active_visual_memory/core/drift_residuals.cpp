#include "active_visual_memory/core/drift_residuals.h"

#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/floor_matching.h"

namespace vismem {

void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, const LeaningView& view,
                       double slack_m, double noise, double end_doubt, double max_end_shift_m,
                       std::vector<DriftResidual>& residuals) {
  const Eigen::Vector2d n = line.normal();
  const Eigen::Vector2d u = line.along();
  const bool against = u.dot(piece.odom.b - piece.odom.a) < 0.0;
  const FloorSegment observed = against ? reversed(piece) : piece;
  const double slack = slack_m * slack_m;
  const double end_noise = noise * end_doubt * end_doubt;
  // The camera's pitch and roll are common to the whole image: what is solved for is no noise.
  const double pitch = observed.pitch_sigma_rad * observed.pitch_sigma_rad;
  const auto variance = [&](const Eigen::Vector2d& direction, const Eigen::Matrix2d& P, const FloorLean& D) {
    return std::max(
        0.0, direction.dot(P * direction) - pitch * (direction.transpose() * D.rightCols<2>()).squaredNorm());
  };
  const auto add = [&](const Eigen::Vector2d& at, const Eigen::Matrix2d& P, const FloorLean& D, bool open,
                       const ExtentEnd& known) {
    const double t = line.tOf(at);
    const LeanRow across = n.transpose() * view.derivativeAt(at - line.offsetOf(at) * n);
    residuals.push_back({at, n, line.offsetOf(at),
                         noise * (variance(n, P, D) + line.offsetVariance(t) + slack),
                         across - line.offsetLean(t), across.head<2>()});
    const double gap = t - known.t_m;
    if (open || known.open || std::abs(gap) > max_end_shift_m) return;
    const LeanRow far = u.transpose() * view.derivativeAt(line.pointAt(known.t_m));
    residuals.push_back({at, u, gap, end_noise * (variance(u, P, D) + known.variance_m2 + slack),
                         far - known.d_lean, far.head<2>()});
  };
  add(observed.odom.a, observed.P_a, observed.D_a, observed.open_a, line.endA());
  add(observed.odom.b, observed.P_b, observed.D_b, observed.open_b, line.endB());
}

}  // namespace vismem
