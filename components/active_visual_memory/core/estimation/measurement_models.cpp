#include "active_visual_memory/core/estimation/measurement_models.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
double ownVariance(const Eigen::Vector2d& direction, const Eigen::Matrix2d& P, const TiltJacobian& D,
                   double pitch_sigma_rad) {
  return std::max(
      0.0, direction.dot(P * direction) -
               pitch_sigma_rad * pitch_sigma_rad * (direction.transpose() * D.rightCols<2>()).squaredNorm());
}

namespace {

/// @param line_estimated  the filter holds the line's own error and its derivative by the tilt.
void compare(const FloorLine& line, const FloorSegment& piece, const TiltView& view, double slack_m,
             double noise, double end_inflation, double max_end_shift_m, bool line_estimated,
             auto across_line, auto along_line) {
  const Eigen::Vector2d n = line.normal();
  const Eigen::Vector2d u = line.along();
  const bool against = u.dot(piece.odom.b - piece.odom.a) < 0.0;
  const FloorSegment observed = against ? reversed(piece) : piece;
  const double slack = slack_m * slack_m;
  const double end_noise = noise * end_inflation * end_inflation;
  const auto variance = [&](const Eigen::Vector2d& direction, const Eigen::Matrix2d& P,
                            const TiltJacobian& D) {
    return ownVariance(direction, P, D, observed.pitch_sigma_rad);
  };
  const auto add = [&](const Eigen::Vector2d& at, const Eigen::Matrix2d& P, const TiltJacobian& D,
                       bool censored, const ExtentEnd& known) {
    const double t = line.tOf(at);
    TiltJacobianRow across = n.transpose() * view.derivativeAt(at - line.offsetOf(at) * n);
    const Eigen::RowVector2d frame_tilt = across.head<2>();
    double of_line = 0.0;
    if (!line_estimated) {
      across -= line.offsetTiltJacobian(t);
      of_line = line.offsetVariance(t);
    }
    across_line(DriftResidual{at, n, line.offsetOf(at), noise * (variance(n, P, D) + of_line + slack), across,
                              frame_tilt});
    const double gap = t - known.t_m;
    if (censored || known.censored || std::abs(gap) > max_end_shift_m) return;
    const TiltJacobianRow far = u.transpose() * view.derivativeAt(line.pointAt(known.t_m));
    along_line(DriftResidual{at, u, gap, end_noise * (variance(u, P, D) + known.variance_m2 + slack),
                             far - known.d_tilt, far.head<2>()});
  };
  add(observed.odom.a, observed.P_a, observed.D_a, observed.censored_a, line.endA());
  add(observed.odom.b, observed.P_b, observed.D_b, observed.censored_b, line.endB());
}

}  // namespace

void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, const TiltView& view, double slack_m,
                       double noise, double end_inflation, double max_end_shift_m,
                       std::vector<DriftResidual>& residuals) {
  const auto add = [&](const DriftResidual& r) { residuals.push_back(r); };
  compare(line, piece, view, slack_m, noise, end_inflation, max_end_shift_m, false, add, add);
}

void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                      const TiltView& view, double slack_m, double noise, double end_inflation,
                      double max_end_shift_m, std::vector<LineResidual>& residuals) {
  compare(
      line, piece, view, slack_m, noise, end_inflation, max_end_shift_m, true,
      [&](const DriftResidual& r) {
        residuals.push_back({r, id});
      },
      [&](const DriftResidual& r) {
        residuals.push_back({r, 0});
      });
}

void addDirectionResiduals(const std::vector<FloorSegment>& floor, const TiltView& view,
                           const CameraTilt& about, const DominantDirectionParams& params,
                           const std::optional<double>& known_rad, std::vector<DriftResidual>& residuals) {
  if (!(params.sigma_rad > 0.0)) return;
  const auto informative = [&](const FloorSegment& s) {
    const Eigen::Vector2d ray = (s.odom.middle() - view.camera.head<2>()).normalized();
    const Eigen::Vector2d along = s.odom.b - s.odom.a;
    const double length = along.norm();
    return length >= params.least_m && std::abs(cross2(ray, along)) >= params.not_radial * length;
  };
  const auto tiltedPoint = [&](const Eigen::Vector2d& p, const TiltJacobian& D) -> Eigen::Vector2d {
    return p + view.derivativeAt(p + 0.5 * D * about) * about;
  };
  // Without a known direction: the one with the most length of other lines along it.
  std::optional<double> direction = known_rad;
  double most = 0.0;
  for (const FloorSegment& candidate : floor) {
    if (known_rad || !informative(candidate)) continue;
    double votes = 0.0;
    for (const FloorSegment& other : floor) {
      if (&other == &candidate || !informative(other)) continue;
      const double off = offDominantDirection(other.odom.direction(), candidate.odom.direction());
      if (std::abs(off) <= params.together_rad) votes += other.odom.length();
    }
    if (votes > most) most = votes, direction = candidate.odom.direction();
  }
  if (!direction) return;
  for (const FloorSegment& s : floor) {
    if (!informative(s)) continue;
    if (std::abs(offDominantDirection(s.odom.direction(), *direction)) > params.together_rad) continue;
    const Segment2 line{tiltedPoint(s.odom.a, s.D_a), tiltedPoint(s.odom.b, s.D_b)};
    const double length = line.length();
    const Eigen::Vector2d along = (line.b - line.a) / length;
    const Eigen::Vector2d n = turned90(along);
    const double own =
        (ownVariance(n, s.P_a, s.D_a, s.pitch_sigma_rad) + ownVariance(n, s.P_b, s.D_b, s.pitch_sigma_rad)) /
        (length * length);
    const TiltJacobianRow d =
        n.transpose() * (view.derivativeAt(line.b) - view.derivativeAt(line.a)) / length;
    const double off = offDominantDirection(line.direction(), *direction) - d.dot(about);
    residuals.push_back({s.odom.middle(), Eigen::Vector2d::Zero(), off,
                         own + params.sigma_rad * params.sigma_rad, d, d.head<2>(), known_rad ? 0.0 : 1.0,
                         known_rad ? 1.0 : 0.0});
  }
}

std::optional<DirectionDeviation> directionDeviation(const std::vector<FloorSegment>& floor,
                                                     const TiltView& view,
                                                     const DominantDirectionParams& params,
                                                     double dominant_direction_rad, double per_frame_rad) {
  DominantDirectionParams wide = params;
  wide.together_rad = params.slip_together_rad;
  std::vector<DriftResidual> residuals;
  CameraTilt about = CameraTilt::Zero();
  Eigen::Vector3d state = Eigen::Vector3d::Zero();  // frame tilt, turn
  Eigen::Matrix3d information;
  for (int i = 0; i < 2; ++i) {
    residuals.clear();
    addDirectionResiduals(floor, view, about, wide, dominant_direction_rad, residuals);
    if (residuals.empty()) return std::nullopt;
    information = Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal();
    information /= per_frame_rad * per_frame_rad;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const DriftResidual& r : residuals) {
      const Eigen::Vector3d h{-r.d_frame_tilt.x(), -r.d_frame_tilt.y(), 1.0};
      information += h * h.transpose() / r.variance_m2;
      right += h * r.residual_m / r.variance_m2;
    }
    state = information.ldlt().solve(right);
    about.head<2>() = state.head<2>();
  }
  return DirectionDeviation{state.z(), information.inverse()(2, 2)};
}

}  // namespace vismem
