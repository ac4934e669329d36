#include "active_visual_memory/core/drift_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace vismem {
namespace {

Eigen::Vector2d turned90(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

constexpr double kLeastVariance = 1e-12;  // [m^2], [rad^2]: of what cannot change

}  // namespace

Eigen::Vector2d SmallMotion::apply(const Eigen::Vector2d& p) const {
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const Eigen::Vector2d d = p - pivot;
  return pivot + shift + Eigen::Vector2d(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

void DriftAlignment::travel(const Pose2& moved, const Params& params) {
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  if (way == 0.0 && turn == 0.0) return;
  // A wrong heading moves the place of the pivot, too; in the frame of odom any direction may be the robot's.
  P_(0, 0) += P_(2, 2) * way * way;
  P_(1, 1) += P_(2, 2) * way * way;
  const double shift = params.shift_per_m * way + params.shift_per_rad * turn;
  const double heading = params.turn_per_rad * turn + params.turn_per_m * way;
  // Drift of the same cause goes on in the same direction: standard deviations add up.
  const auto grow = [](double variance, double sigma) {
    const double grown = std::sqrt(variance) + sigma;
    return grown * grown;
  };
  P_(0, 0) = grow(P_(0, 0), shift);
  P_(1, 1) = grow(P_(1, 1), shift);
  P_(2, 2) = grow(P_(2, 2), heading);
}

double DriftAlignment::sigmaAt(double distance_m) const {
  return std::sqrt(0.5 * (P_(0, 0) + P_(1, 1)) + distance_m * distance_m * P_(2, 2));
}

void DriftAlignment::reset() {
  const LeanCovariance known = leanCovariance();
  P_.setZero();
  P_.bottomRightCorner<4, 4>() = known;
}

std::optional<Correction> DriftAlignment::solve(const Eigen::Vector2d& robot,
                                                std::span<const DriftResidual> residuals,
                                                const Params& params) {
  if (residuals.empty() || !(P_.trace() > 0.0)) return std::nullopt;
  using Vector = Eigen::Matrix<double, 9, 1>;  // drift, lean, sway
  using Matrix = Eigen::Matrix<double, 9, 9>;
  Matrix P = Matrix::Zero();
  P.topLeftCorner<7, 7>() = P_;
  P.bottomRightCorner<2, 2>().diagonal().setConstant(lean_params_.sway_rad * lean_params_.sway_rad);
  const Matrix prior = (P + kLeastVariance * Matrix::Identity()).inverse();
  Vector state = Vector::Zero();
  Matrix information = prior;
  for (int i = 0; i < params.iterations; ++i) {
    information = prior;
    Vector right = Vector::Zero();
    for (const DriftResidual& r : residuals) {
      Vector h;
      h << r.direction, r.direction.dot(turned90(r.p - robot)), -r.d_lean.transpose(), -r.d_sway.transpose();
      // The gate opens by what the drift may be; at the end only what agrees with the rest counts.
      const double spread = i == 0 ? h.dot(P * h) : 0.0;
      const double sigma = std::sqrt(r.variance_m2);
      const double off = std::abs(r.residual_m - h.dot(state)) / std::sqrt(r.variance_m2 + spread);
      if (off > params.gate) continue;
      const double weight = off <= params.huber ? 1.0 : params.huber / off;
      const double w = weight / (sigma * sigma);
      information += w * h * h.transpose();
      right += w * r.residual_m * h;
    }
    state = information.ldlt().solve(right);
  }
  P_ = information.inverse().topLeftCorner<7, 7>();
  Correction correction{{robot, state.head<2>(), state[2]}, Lean::Zero(), state.tail<2>()};
  const Lean most = lean_params_.most_sigmas * lean_params_.prior().diagonal().cwiseSqrt();
  const Lean before = lean_;
  lean_ = (before + state.segment<4>(3)).cwiseMax(-most).cwiseMin(most);
  correction.lean = lean_ - before;
  for (int i = 0; i < 4; ++i) {
    const double least = std::min(lean_params_.floor_rad, most[i]);
    P_(3 + i, 3 + i) = std::max(P_(3 + i, 3 + i), least * least);
  }
  return correction;
}

}  // namespace vismem
