#include "active_visual_memory/core/drift_residuals.h"

#include <cmath>

#include "active_visual_memory/core/floor_matching.h"

namespace vismem {

void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, double slack_m, double noise,
                       double max_end_shift_m, std::vector<DriftResidual>& residuals) {
  const Eigen::Vector2d n = line.normal();
  const Eigen::Vector2d u = line.along();
  const bool against = u.dot(piece.odom.b - piece.odom.a) < 0.0;
  const FloorSegment observed = against ? reversed(piece) : piece;
  const double slack = slack_m * slack_m;
  const auto add = [&](const Eigen::Vector2d& at, const Eigen::Matrix2d& P, bool open,
                       const ExtentEnd& known) {
    const double t = line.tOf(at);
    residuals.push_back({at, n, line.offsetOf(at), noise * (n.dot(P * n) + line.offsetVariance(t) + slack)});
    const double gap = t - known.t_m;
    if (open || known.open || std::abs(gap) > max_end_shift_m) return;
    residuals.push_back({at, u, gap, noise * (u.dot(P * u) + known.variance_m2 + slack)});
  };
  add(observed.odom.a, observed.P_a, observed.open_a, line.endA());
  add(observed.odom.b, observed.P_b, observed.open_b, line.endB());
}

}  // namespace vismem
