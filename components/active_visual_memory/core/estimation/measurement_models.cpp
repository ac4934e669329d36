#include "active_visual_memory/core/estimation/measurement_models.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
double ownVariance(const Eigen::Vector2d& direction, const FloorEnd& end, double pitch_sigma_rad) {
  return std::max(
      0.0, end.varianceAlong(direction) - pitch_sigma_rad * pitch_sigma_rad *
                                              (direction.transpose() * end.D.rightCols<2>()).squaredNorm());
}

namespace {

/// Direction of a long line of one image against a known one.
struct DirectionResidual {
  double off_rad = 0.0;
  double variance = 0.0;            ///< [rad^2]
  Eigen::RowVector2d d_frame_tilt;  ///< derivative of the observed direction
};

/// @param about  frame tilt at which the derivatives are taken: lines placed too far away turn too much with
///               the tilt, which would bias the estimate.
template <typename Use>
void forEachDirection(std::span<const FloorSegment> floor, const TiltView& view, const Eigen::Vector2d& about,
                      const DominantDirectionParams& params, double known_rad, const Use& use) {
  for (const FloorSegment& s : floor) {
    const Eigen::Vector2d ray = (s.odom().middle() - view.camera.head<2>()).normalized();
    const Eigen::Vector2d seen = s.b.p - s.a.p;
    if (seen.norm() < params.least_m || std::abs(cross2(ray, seen)) < params.not_radial * seen.norm())
      continue;
    if (std::abs(offDominantDirection(s.odom().direction(), known_rad)) > params.slip_together_rad) continue;
    CameraTilt tilt = CameraTilt::Zero();
    tilt.head<2>() = about;
    const auto tiltedPoint = [&](const FloorEnd& end) -> Eigen::Vector2d {
      return end.p + view.derivativeAt(end.p + 0.5 * end.D * tilt) * tilt;
    };
    const Segment2 line{tiltedPoint(s.a), tiltedPoint(s.b)};
    const double length = line.length();
    const Eigen::Vector2d n = turned90(Eigen::Vector2d((line.b - line.a) / length));
    const double own =
        (ownVariance(n, s.a, s.pitch_sigma_rad) + ownVariance(n, s.b, s.pitch_sigma_rad)) / (length * length);
    const TiltJacobianRow d =
        n.transpose() * (view.derivativeAt(line.b) - view.derivativeAt(line.a)) / length;
    use({offDominantDirection(line.direction(), known_rad) - d.head<2>().dot(about),
         own + params.sigma_rad * params.sigma_rad, d.head<2>()});
  }
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

std::optional<DirectionDeviation> directionDeviation(std::span<const FloorSegment> floor,
                                                     const TiltView& view,
                                                     const DominantDirectionParams& params,
                                                     double dominant_direction_rad, double per_frame_rad) {
  if (!(params.sigma_rad > 0.0)) return std::nullopt;
  Eigen::Vector3d state = Eigen::Vector3d::Zero();  // frame tilt, turn
  Eigen::Matrix3d information;
  // Linearized twice, the second time about the tilt of the first one.
  for (int i = 0; i < 2; ++i) {
    bool any = false;
    information = Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal();
    information /= per_frame_rad * per_frame_rad;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto add = [&](const DirectionResidual& r) {
      const Eigen::Vector3d h{-r.d_frame_tilt.x(), -r.d_frame_tilt.y(), 1.0};
      information += h * h.transpose() / r.variance;
      right += h * r.off_rad / r.variance;
      any = true;
    };
    forEachDirection(floor, view, state.head<2>(), params, dominant_direction_rad, add);
    if (!any) return std::nullopt;
    state = information.ldlt().solve(right);
  }
  return DirectionDeviation{state.z(), information.inverse()(2, 2)};
}

}  // namespace vismem
