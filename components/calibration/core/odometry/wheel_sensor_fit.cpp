#include "calibration/core/odometry/wheel_sensor_fit.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "calibration/core/odometry/wheel_path.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr std::size_t kLeastMotions = 10;
constexpr int kStarts = 8;
constexpr double kCauchy = 2.5;
constexpr int kRounds = 4;
/// Noise of the sensor's motions before the residuals show it.
constexpr double kFirstPosition_m = 0.002;
constexpr double kFirstTurn_rad = 0.005;
constexpr double kSmallest_m = 1e-4;

template <typename T>
Eigen::Matrix<T, 3, 1> predicted(const T* p, const WheelSensorMotion& m) {
  using std::cos;
  using std::sin;
  const T left = p[0] * (m.left_radps * m.duration_s);
  const T right = p[1] * (m.right_radps * m.duration_s);
  const T turn = (right - left) / p[2];
  // In pieces: advanced() is exact for small turns only.
  constexpr int kPieces = 8;
  Eigen::Matrix<T, 3, 1> q(T(0.0), T(0.0), T(0.0));
  for (int i = 0; i < kPieces; ++i) {
    q = advanced<T>(q, (left + right) * (0.5 / kPieces), turn / static_cast<double>(kPieces));
  }
  // Sensor to sensor: inverse(place) * motion * place.
  const T dx = q[0] + cos(q[2]) * p[3] - sin(q[2]) * p[4] - p[3];
  const T dy = q[1] + sin(q[2]) * p[3] + cos(q[2]) * p[4] - p[4];
  const T c = cos(p[5]);
  const T s = sin(p[5]);
  return {c * dx + s * dy, c * dy - s * dx, q[2]};
}

struct MotionCost {
  const WheelSensorMotion* motion;
  double inverse_position;
  double inverse_turn;

  template <typename T>
  bool operator()(const T* p, T* residual) const {
    const Eigen::Matrix<T, 3, 1> q = predicted<T>(p, *motion);
    residual[0] = (q[0] - motion->sensor.x()) * inverse_position;
    residual[1] = (q[1] - motion->sensor.y()) * inverse_position;
    residual[2] = (q[2] - motion->sensor.z()) * inverse_turn;
    return true;
  }
};

using Values = std::array<double, 6>;

WheelSensorParameters parametersOf(const Values& v) {
  return {v[0], v[1], v[2], v[3], v[4], wrapAngle(v[5])};
}

void addMotions(ceres::Problem& problem, const std::vector<WheelSensorMotion>& motions, double position_m,
                double turn_rad, Values& values) {
  for (const WheelSensorMotion& motion : motions) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MotionCost, 3, 6>(
                                 new MotionCost{&motion, 1.0 / position_m, 1.0 / turn_rad}),
                             new ceres::CauchyLoss(kCauchy), values.data());
  }
  for (const int i : {0, 1, 2}) problem.SetParameterLowerBound(values.data(), i, kSmallest_m);
}

/// @return the cost; infinite where nothing converged, or at a bound: the mirrored solution lies beyond it.
double solveFrom(const std::vector<WheelSensorMotion>& motions, double position_m, double turn_rad,
                 Values& values) {
  ceres::Problem problem;
  addMotions(problem, motions, position_m, turn_rad, values);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const bool inside = *std::min_element(values.begin(), values.begin() + 3) > 2.0 * kSmallest_m;
  return summary.IsSolutionUsable() && inside ? summary.final_cost : std::numeric_limits<double>::infinity();
}

/// Standard deviation of normal errors from the median of absolute values.
double robustSigma(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 1.4826 * *middle;
}

void refineNoise(const std::vector<WheelSensorMotion>& motions, const Values& values, WheelSensorFit& fit) {
  std::vector<double> position;
  std::vector<double> turn;
  for (const WheelSensorMotion& motion : motions) {
    const Eigen::Vector3d error = predicted<double>(values.data(), motion) - motion.sensor;
    position.push_back(std::abs(error.x()));
    position.push_back(std::abs(error.y()));
    turn.push_back(std::abs(error.z()));
  }
  fit.position_sigma_m = std::max(robustSigma(std::move(position)), 1e-6);
  fit.turn_sigma_rad = std::max(robustSigma(std::move(turn)), 1e-6);
}

/// Sandwich covariance (Huber 1967): right also where a part of the motions are outliers.
Eigen::Matrix<double, 6, 6> covarianceOf(const std::vector<WheelSensorMotion>& motions, const Values& values,
                                         const WheelSensorFit& fit) {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> G = H;
  for (const WheelSensorMotion& motion : motions) {
    const ceres::AutoDiffCostFunction<MotionCost, 3, 6> cost(
        new MotionCost{&motion, 1.0 / fit.position_sigma_m, 1.0 / fit.turn_sigma_rad});
    Eigen::Vector3d r;
    Eigen::Matrix<double, 3, 6, Eigen::RowMajor> J;
    const double* block = values.data();
    double* jacobian = J.data();
    cost.Evaluate(&block, r.data(), &jacobian);
    const double weight = 1.0 / (1.0 + r.squaredNorm() / (kCauchy * kCauchy));
    const Eigen::Matrix<double, 6, 1> gradient = weight * J.transpose() * r;
    G += gradient * gradient.transpose();
    // Second derivative of the loss along the residual.
    const double along = weight * weight * (1.0 - r.squaredNorm() / (kCauchy * kCauchy));
    const double norm2 = std::max(r.squaredNorm(), 1e-12);
    const Eigen::Matrix3d curvature =
        weight * Eigen::Matrix3d::Identity() + (along - weight) * (r * r.transpose()) / norm2;
    H += J.transpose() * curvature * J;
  }
  const Eigen::Matrix<double, 6, 6> inverse = H.inverse();
  return inverse * G * inverse;
}

}  // namespace

Eigen::Vector3d predictedSensorMotion(const WheelSensorParameters& parameters,
                                      const WheelSensorMotion& motion) {
  const Eigen::Matrix<double, 6, 1> p = parameters.vector();
  return predicted<double>(p.data(), motion);
}

WheelSensorFit fitWheelsAndSensor(const std::vector<WheelSensorMotion>& motions, double radius_m,
                                  double base_m) {
  if (motions.size() < kLeastMotions) {
    throw std::runtime_error(std::to_string(motions.size()) + " motions (at least " +
                             std::to_string(kLeastMotions) + " are needed)");
  }
  WheelSensorFit fit;
  fit.position_sigma_m = kFirstPosition_m;
  fit.turn_sigma_rad = kFirstTurn_rad;
  std::optional<Values> best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kStarts; ++i) {
    Values values{radius_m, radius_m, base_m, 0.0, 0.0, 2.0 * std::numbers::pi * i / kStarts};
    const double cost = solveFrom(motions, fit.position_sigma_m, fit.turn_sigma_rad, values);
    if (cost >= least) continue;
    least = cost;
    best = values;
  }
  for (int round = 0; best && round < kRounds; ++round) {
    refineNoise(motions, *best, fit);
    if (!std::isfinite(solveFrom(motions, fit.position_sigma_m, fit.turn_sigma_rad, *best))) best.reset();
  }
  if (!best) {
    throw std::runtime_error(
        "no solution with wheels of positive radius: are left and right, or a sign of the speeds, swapped?");
  }
  fit.parameters = parametersOf(*best);
  fit.covariance = covarianceOf(motions, *best, fit);
  return fit;
}

}  // namespace vismem
