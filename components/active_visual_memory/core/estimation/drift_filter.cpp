#include "active_visual_memory/core/estimation/drift_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "active_visual_memory/core/estimation/state_limits.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kLeastVariance = 1e-12;  // [m^2], [rad^2]: of unknowns fixed by their prior
constexpr double kDirection = 0.2;        // [rad] prior sigma of the direction of the lines

}  // namespace

PlanarIncrement DriftFilter::predict(const Pose2& before, const Pose2& now, const Params& params) {
  const Pose2 moved = inverse(before) * now;
  const double way = moved.position().norm();
  const double turn = std::abs(moved.theta);
  PlanarIncrement expected{before.position(), Eigen::Vector2d::Zero(), 0.0};
  if (way == 0.0 && turn == 0.0) return expected;
  const Eigen::Vector2d most{params.turn_per_rad, params.turn_per_m};
  if (!moved_) {
    P_.block<2, 2>(kRates, kRates) = most.cwiseAbs2().asDiagonal();
    moved_ = true;
  }
  // Driving backwards inverts the drift per metre.
  const Eigen::Vector2d gone{moved.theta, std::copysign(way, moved.x)};
  expected.turn_rad = gone.dot(rates_);
  const Eigen::Matrix<double, 1, kLasting> carried = gone.transpose() * P_.middleRows<2>(kRates);
  P_.row(kTurn) += carried;
  P_.col(kTurn) += carried.transpose();
  P_(kTurn, kTurn) += gone.dot(P_.block<2, 2>(kRates, kRates) * gone);
  // A heading error also displaces the pivot; in odom, any direction may be that of the robot.
  P_(0, 0) += P_(kTurn, kTurn) * way * way;
  P_(1, 1) += P_(kTurn, kTurn) * way * way;
  const double shift = params.shift_per_m * way + params.shift_per_rad * turn;
  const double heading = kUnbiasedDriftShare * (params.turn_per_rad * turn + params.turn_per_m * way);
  // Successive drift is fully correlated: standard deviations add up.
  const auto grow = [](double variance, double sigma) {
    const double grown = std::sqrt(variance) + sigma;
    return grown * grown;
  };
  P_(0, 0) = grow(P_(0, 0), shift);
  P_(1, 1) = grow(P_(1, 1), shift);
  P_(kTurn, kTurn) = grow(P_(kTurn, kTurn), heading);
  return expected;
}

double DriftFilter::sigmaAt(double distance_m) const {
  return std::sqrt(0.5 * (P_(0, 0) + P_(1, 1)) + distance_m * distance_m * P_(kTurn, kTurn));
}

void DriftFilter::reset() {
  P_.topRows<kTilt>().setZero();
  P_.leftCols<kTilt>().setZero();
}

std::optional<Correction> DriftFilter::update(const Eigen::Vector2d& robot,
                                              std::span<const DriftResidual> residuals,
                                              const Params& params) {
  if (residuals.empty() || !(P_.trace() > 0.0)) return std::nullopt;
  constexpr int kFrameTilt = kLasting;
  constexpr int kAll = kFrameTilt + 3;  // the last one: the direction of this image's lines
  using Vector = Eigen::Matrix<double, kAll, 1>;
  using Matrix = Eigen::Matrix<double, kAll, kAll>;
  Matrix P = Matrix::Zero();
  P.topLeftCorner<kLasting, kLasting>() = P_;
  P.block<2, 2>(kFrameTilt, kFrameTilt)
      .diagonal()
      .setConstant(tilt_prior_.per_frame_rad * tilt_prior_.per_frame_rad);
  P(kAll - 1, kAll - 1) = kDirection * kDirection;
  const Matrix prior = (P + kLeastVariance * Matrix::Identity()).inverse();
  Vector state = Vector::Zero();
  Matrix information = prior;
  for (int i = 0; i < params.iterations; ++i) {
    information = prior;
    Vector right = Vector::Zero();
    for (const DriftResidual& r : residuals) {
      Vector h;
      h << r.direction, r.direction.dot(turned90(r.p - robot)) + r.d_turn, -r.d_tilt.transpose(),
          Eigen::Vector2d::Zero(), -r.d_frame_tilt.transpose(), r.d_direction;
      // The first gate includes the prior variance of the residual; later ones compare with the estimate.
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
                        CameraTilt::Zero(),
                        state.segment<2>(kFrameTilt),
                        known.block<2, 2>(kFrameTilt, kFrameTilt)};
  const CameraTilt before = camera_tilt_;
  camera_tilt_ += state.segment<4>(kTilt);
  limitCameraTilt(tilt_prior_, camera_tilt_, P_.block<4, 4>(kTilt, kTilt));
  correction.camera_tilt = camera_tilt_ - before;
  rates_ += state.segment<2>(kRates);
  limitRates({params.turn_per_rad, params.turn_per_m}, rates_, P_.block<2, 2>(kRates, kRates));
  return correction;
}

}  // namespace vismem
