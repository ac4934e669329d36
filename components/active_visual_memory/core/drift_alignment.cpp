#include "active_visual_memory/core/drift_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace vismem {
namespace {

Eigen::Vector2d turned90(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

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

std::optional<SmallMotion> DriftAlignment::solve(const Eigen::Vector2d& robot,
                                                 std::span<const DriftResidual> residuals,
                                                 const Params& params) {
  if (residuals.empty() || !(P_.trace() > 0.0)) return std::nullopt;
  const Eigen::Matrix3d prior = (P_ + 1e-10 * Eigen::Matrix3d::Identity()).inverse();
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = prior;
  for (int i = 0; i < params.iterations; ++i) {
    information = prior;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const DriftResidual& r : residuals) {
      const Eigen::Vector3d h{r.direction.x(), r.direction.y(), r.direction.dot(turned90(r.p - robot))};
      // The gate opens by what the drift may be; at the end only what agrees with the rest counts.
      const double spread = i == 0 ? h.dot(P_ * h) : 0.0;
      const double sigma = std::sqrt(r.variance_m2);
      const double off = std::abs(r.residual_m - h.dot(drift)) / std::sqrt(r.variance_m2 + spread);
      if (off > params.gate) continue;
      const double weight = off <= params.huber ? 1.0 : params.huber / off;
      const double w = weight / (sigma * sigma);
      information += w * h * h.transpose();
      right += w * r.residual_m * h;
    }
    drift = information.ldlt().solve(right);
  }
  P_ = information.inverse();
  return SmallMotion{robot, drift.head<2>(), drift.z()};
}

}  // namespace vismem
