#include "active_visual_memory/core/drift_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "active_visual_memory/core/drift_limits.h"

namespace vismem {
namespace {

Eigen::Vector2d turned90(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

constexpr double kLeastVariance = 1e-12;  // [m^2], [rad^2]: of what cannot change
constexpr double kCourse = 0.2;           // [rad] sigma of the first guess of the lines' course

}  // namespace

Eigen::Vector2d SmallMotion::apply(const Eigen::Vector2d& p) const {
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const Eigen::Vector2d d = p - pivot;
  return pivot + shift + Eigen::Vector2d(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

SmallMotion DriftAlignment::travel(const Pose2& before, const Pose2& now, const Params& params) {
  const Pose2 moved = inverse(before) * now;
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  SmallMotion expected{before.position(), Eigen::Vector2d::Zero(), 0.0};
  if (way == 0.0 && turn == 0.0) return expected;
  const Eigen::Vector2d most{params.turn_per_rad, params.turn_per_m};
  if (!moved_) {
    P_.block<2, 2>(kRates, kRates) = most.cwiseAbs2().asDiagonal();
    moved_ = true;
  }
  // A robot that goes backwards drifts back.
  const Eigen::Vector2d gone{moved.theta, std::copysign(way, moved.x)};
  expected.turn_rad = gone.dot(rates_);
  const Eigen::Matrix<double, 1, kLasting> carried = gone.transpose() * P_.middleRows<2>(kRates);
  P_.row(kTurn) += carried;
  P_.col(kTurn) += carried.transpose();
  P_(kTurn, kTurn) += gone.dot(P_.block<2, 2>(kRates, kRates) * gone);
  // A wrong heading moves the place of the pivot, too; in the frame of odom any direction may be the robot's.
  P_(0, 0) += P_(kTurn, kTurn) * way * way;
  P_(1, 1) += P_(kTurn, kTurn) * way * way;
  const double shift = params.shift_per_m * way + params.shift_per_rad * turn;
  const double heading = kChangingDrift * (params.turn_per_rad * turn + params.turn_per_m * way);
  // Drift of the same cause goes on in the same direction for a while: standard deviations add up.
  const auto grow = [](double variance, double sigma) {
    const double grown = std::sqrt(variance) + sigma;
    return grown * grown;
  };
  P_(0, 0) = grow(P_(0, 0), shift);
  P_(1, 1) = grow(P_(1, 1), shift);
  P_(kTurn, kTurn) = grow(P_(kTurn, kTurn), heading);
  return expected;
}

double DriftAlignment::sigmaAt(double distance_m) const {
  return std::sqrt(0.5 * (P_(0, 0) + P_(1, 1)) + distance_m * distance_m * P_(kTurn, kTurn));
}

void DriftAlignment::reset() {
  P_.topRows<kLean>().setZero();
  P_.leftCols<kLean>().setZero();
}

std::optional<Correction> DriftAlignment::solve(const Eigen::Vector2d& robot,
                                                std::span<const DriftResidual> residuals,
                                                const Params& params) {
  if (residuals.empty() || !(P_.trace() > 0.0)) return std::nullopt;
  constexpr int kSway = kLasting;
  constexpr int kAll = kSway + 3;  // the last one: the course of this image's lines
  using Vector = Eigen::Matrix<double, kAll, 1>;
  using Matrix = Eigen::Matrix<double, kAll, kAll>;
  Matrix P = Matrix::Zero();
  P.topLeftCorner<kLasting, kLasting>() = P_;
  P.block<2, 2>(kSway, kSway).diagonal().setConstant(lean_params_.sway_rad * lean_params_.sway_rad);
  P(kAll - 1, kAll - 1) = kCourse * kCourse;
  const Matrix prior = (P + kLeastVariance * Matrix::Identity()).inverse();
  Vector state = Vector::Zero();
  Matrix information = prior;
  for (int i = 0; i < params.iterations; ++i) {
    information = prior;
    Vector right = Vector::Zero();
    for (const DriftResidual& r : residuals) {
      Vector h;
      h << r.direction, r.direction.dot(turned90(r.p - robot)) + r.d_turn, -r.d_lean.transpose(),
          Eigen::Vector2d::Zero(), -r.d_sway.transpose(), r.d_course;
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
  const Matrix known = information.inverse();
  P_ = known.topLeftCorner<kLasting, kLasting>();
  Correction correction{{robot, state.head<2>(), state[kTurn]},
                        Lean::Zero(),
                        state.segment<2>(kSway),
                        known.block<2, 2>(kSway, kSway)};
  const Lean before = lean_;
  lean_ += state.segment<4>(kLean);
  keepWithin(lean_params_, lean_, P_.block<4, 4>(kLean, kLean));
  correction.lean = lean_ - before;
  rates_ += state.segment<2>(kRates);
  keepRatesWithin({params.turn_per_rad, params.turn_per_m}, rates_, P_.block<2, 2>(kRates, kRates));
  return correction;
}

}  // namespace vismem
