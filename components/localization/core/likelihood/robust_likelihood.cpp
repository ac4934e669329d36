#include "localization/core/likelihood/robust_likelihood.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kTruncation_m = 1.0;          // of the fields: several times the largest sigma with blur
constexpr double kMinimumPlanLength_m = 0.03;  // shorter map segments are vertical edges

constexpr std::size_t kPreview = 4;  // explain() rates every n-th point first

/// exp(-loss) from this loss on is below the resolution of the sums.
constexpr double kNoAgreement = 40.0;
double agreement(double loss) {
  return loss > kNoAgreement ? 0.0 : std::exp(-loss);
}

/// Calls use(level, where the point's ray passes it) for each level at which the point may lie.
/// @param on_floor where the ray meets the floor.
template <typename Use>
void atEachLevel(const MapIndex& map, const FloorPoint& point, const Eigen::Vector2d& on_floor,
                 const Use& use) {
  for (const MapIndex::Level& level : map.levels(point.label)) {
    if (!point.mayLieAt(level.height_m)) continue;
    if (level.height_m == 0.0) {
      use(level, on_floor);
    } else {
      const Eigen::Vector2d ray = on_floor - point.camera_robot;
      use(level, point.camera_robot + point.shareAt(level.height_m) * ray);
    }
  }
}

/// Damping of directions that the observation leaves undetermined: 1 m, 1 rad.
const Matrix5d kDamping = Matrix5d::Identity();

/// Prior standard deviation of a frame tilt that is fixed at 0.
constexpr double kFixedTilt_rad = 1e-6;

/// Longest step for which the gradient describes the field.
constexpr double kLongestStep_m = 0.5;
constexpr double kLongestTurn_rad = 0.4;
/// Convergence: after a smaller step the iteration ends.
constexpr double kSmallStep_m = 5e-4;
constexpr double kSmallStep_rad = 5e-4;

/// Steps with widened sigmas, and the factor on the predicted variance from one to the next.
constexpr int kWideSteps = 3;
constexpr double kNarrowing = 0.1;

}  // namespace

MapIndex::Params robustIndex(const LikelihoodParams& params, const MapParams& map) {
  MapIndex::Params index;
  index.cell_m = map.cell_m;
  index.reach_m = kTruncation_m;
  if (params.direction_gate) index.direction_gate_rad = params.direction_gate_rad;
  index.minimum_plan_length_m = kMinimumPlanLength_m;
  return index;
}

double RobustLikelihood::explainedVariance(const FloorPoint& point, double blur_m) const {
  const double sigma_m = std::max(point.sigma_m, params_.explained_sigma_m);
  return sigma_m * sigma_m + blur_m * blur_m;
}

void RobustLikelihood::add(Rating& rating, const FloorPoint& point, double distance_m, double blur_m) const {
  const double eps = params_.outlier_share;
  const double variance = point.sigma_m * point.sigma_m + blur_m * blur_m;
  const auto addTerm = [&](double log_likelihood) { rating.log_likelihood += point.weight * log_likelihood; };
  if (distance_m >= kTruncation_m) {
    addTerm(params_.bounded ? log_outlier_share_ : -0.5 * kTruncation_m * kTruncation_m / variance);
    return;
  }
  const double half_square = 0.5 * distance_m * distance_m;
  rating.explained += point.weight * agreement(half_square / explainedVariance(point, blur_m));
  const double loss = half_square / variance;
  if (!params_.bounded) return addTerm(-loss);
  addTerm(loss > kNoAgreement ? log_outlier_share_ : std::log((1.0 - eps) * std::exp(-loss) + eps));
}

Rating RobustLikelihood::rate(const FloorObservation& observation, const Placement& placement,
                              double blur_m) const {
  const Pose2& pose = placement.T_world_robot;
  const Eigen::Vector2d tilt = placement.tilt();
  Rating rating;
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  for (const FloorPoint& point : observation.points) {
    const Eigen::Vector2d on_floor = point.p_robot + point.d_tilt * tilt;
    double square = kTruncation_m * kTruncation_m;
    atEachLevel(map_, point, on_floor, [&](const MapIndex::Level& level, const Eigen::Vector2d& p_robot) {
      const Eigen::Vector2d p(pose.x + c * p_robot.x() - s * p_robot.y(),
                              pose.y + s * p_robot.x() + c * p_robot.y());
      square = std::min(square, map_.nearestSquare(level.field, p, point.direction_robot + pose.theta));
    });
    add(rating, point, std::sqrt(square), blur_m);
  }
  if (!observation.points.empty()) rating.explained /= weightOf(observation);
  return rating;
}

void RobustLikelihood::explain(const FloorObservation& observation, std::span<Individual> places,
                               double blur_m, double least) const {
  assert(observation.points.size() <= kMaximumPoints);
  struct Sample {
    const FloorPoint* point;
    double per_square;  // loss per squared distance [1/m^2]
  };
  std::array<Sample, kMaximumPoints> samples;
  std::size_t count = 0;
  std::size_t previewed = 0;
  double preview_weight = 0.0;
  double weight = 0.0;
  for (std::size_t begin = 0; begin < kPreview; ++begin) {
    for (std::size_t i = begin; i < observation.points.size(); i += kPreview) {
      const FloorPoint& point = observation.points[i];
      const double per_square = 0.5 / explainedVariance(point, blur_m);
      samples[count++] = {&point, per_square};
      weight += point.weight;
    }
    if (begin > 0) continue;
    previewed = count;
    preview_weight = weight;
  }
  const auto add = [&](Individual& place, std::span<const Sample> some) {
    const Pose2& pose = place.T_world_robot;
    const double c = std::cos(pose.theta);
    const double s = std::sin(pose.theta);
    for (const Sample& sample : some) {
      const FloorPoint& point = *sample.point;
      double square = kTruncation_m * kTruncation_m;
      atEachLevel(map_, point, point.p_robot, [&](const MapIndex::Level& level, const Eigen::Vector2d& p) {
        const Eigen::Vector2d at(pose.x + c * p.x() - s * p.y(), pose.y + s * p.x() + c * p.y());
        square = std::min(square, map_.nearestSquare(level.field, at, point.direction_robot + pose.theta));
      });
      if (square >= kTruncation_m * kTruncation_m) continue;
      place.health += point.weight * agreement(square * sample.per_square);
    }
  };
  const std::span<const Sample> all(samples.data(), count);
  for (Individual& place : places) {
    place.health = 0.0;
    add(place, all.first(previewed));
    if (weight > 0.0 && place.health >= 0.5 * least * preview_weight) {
      add(place, all.subspan(previewed));
      place.health /= weight;
    } else {
      place.health = 0.0;
    }
  }
}

/// Quadratic form of -share * log L around a placement, in (x, y, theta, camera tilt).
struct RobustLikelihood::Curvature {
  Matrix5d H = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
  double inlier_weight = 0.0;  ///< points, each by its influence
  double inlier_square = 0.0;  ///< the same, times (d / sigma)^2
};

/// What widens the sigma of each point.
struct RobustLikelihood::Blur {
  double every_m = 0.0;           ///< of every point alike
  Matrix5d P = Matrix5d::Zero();  ///< predicted covariance of (x, y, theta, tilt)
  double predicted_share = 0.0;   ///< of the variance that P predicts for the distance of a point

  double variance(const Vector5d& J) const {
    double variance = every_m * every_m;
    if (predicted_share > 0.0) {
      variance += predicted_share * std::min(J.dot(P * J), kMaximumSigma_m * kMaximumSigma_m);
    }
    return variance;
  }
};

/// A point beside the nearest line of the map.
struct RobustLikelihood::Match {
  FieldSample field;
  Eigen::Vector2d arm;                   ///< from the robot to the point, in the world's axes [m]
  double share_of_way = 1.0;             ///< of the camera's ray, at which the point lies
  Vector5d jacobian = Vector5d::Zero();  ///< of the distance by (x, y, theta, tilt)
  double variance = 0.0;                 ///< [m^2]
  double influence = 1.0;  ///< derivative of the bounded loss (iteratively reweighted least squares)
};

std::optional<RobustLikelihood::Match> RobustLikelihood::match(const FloorPoint& point,
                                                               const Placement& placement,
                                                               const Eigen::Matrix2d& R,
                                                               const Blur& blur) const {
  const Pose2& pose = placement.T_world_robot;
  const Eigen::Vector2d on_floor = point.p_robot + point.d_tilt * placement.tilt();
  std::optional<Match> match;
  atEachLevel(map_, point, on_floor, [&](const MapIndex::Level& level, const Eigen::Vector2d& p_robot) {
    const Eigen::Vector2d there = R * p_robot;
    const auto found = map_.nearest(level.field, pose.position() + there, point.direction_robot + pose.theta);
    if (!found || (match && found->distance_m >= match->field.distance_m)) return;
    match = Match{*found, there, point.shareAt(level.height_m)};
  });
  if (!match) return match;
  const Eigen::Vector2d& gradient = match->field.gradient;
  match->jacobian << gradient, gradient.y() * match->arm.x() - gradient.x() * match->arm.y(),
      match->share_of_way * point.d_tilt.transpose() * (R.transpose() * gradient);
  const double eps = params_.outlier_share;
  match->variance = point.sigma_m * point.sigma_m + blur.variance(match->jacobian);
  const double distance_m = match->field.distance_m;
  const double inlier = (1.0 - eps) * std::exp(-0.5 * distance_m * distance_m / match->variance);
  if (params_.bounded) match->influence = inlier / (inlier + eps);
  return match;
}

RobustLikelihood::Curvature RobustLikelihood::curvature(std::span<const FloorPoint> points,
                                                        const Placement& placement, double share,
                                                        const Blur& blur, Rating* rating) const {
  Curvature result;
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(placement.T_world_robot.theta).toRotationMatrix();
  for (const FloorPoint& point : points) {
    const auto found = match(point, placement, R, blur);
    if (rating) add(*rating, point, found ? found->field.distance_m : kTruncation_m, blur.every_m);
    if (!found) continue;
    const double distance_m = found->field.distance_m;
    const double weight = share * point.weight / found->variance * found->influence;
    result.inlier_weight += point.weight * found->influence;
    result.inlier_square += point.weight * found->influence * distance_m * distance_m / found->variance;
    const Vector5d& J = found->jacobian;
    result.H += weight * J * J.transpose();
    result.g += weight * distance_m * J;
  }
  return result;
}

CameraEvidence RobustLikelihood::cameraEvidence(const FloorObservation& observation,
                                                const Placement& placement,
                                                std::span<const CameraJacobian> derivatives,
                                                double blur_m) const {
  // Pose and tilt of this image, then the errors of the camera.
  constexpr int kAll = 5 + kCameraErrors;
  Eigen::Matrix<double, kAll, kAll> H = Eigen::Matrix<double, kAll, kAll>::Zero();
  Eigen::Matrix<double, kAll, 1> g = Eigen::Matrix<double, kAll, 1>::Zero();
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(placement.T_world_robot.theta).toRotationMatrix();
  for (std::size_t i = 0; i < derivatives.size(); ++i) {
    const FloorPoint& point = observation.points[observation.remembered + i];
    const auto found = match(point, placement, R, {blur_m});
    if (!found) continue;
    Eigen::Matrix<double, kAll, 1> J;
    J.head<5>() = found->jacobian;
    J.tail<kCameraErrors>() =
        found->share_of_way * derivatives[i].transpose() * (R.transpose() * found->field.gradient);
    const double weight = point.weight / found->variance * found->influence;
    // The tilt of this image counts from 0.
    const double distance_m = found->field.distance_m - J.segment<2>(3).dot(placement.tilt());
    H += weight * J * J.transpose();
    g += weight * distance_m * J;
  }
  Matrix5d free = H.topLeftCorner<5, 5>() + kDamping;
  const double tilt = std::max(params_.frame_tilt_rad, kFixedTilt_rad);
  free.diagonal().tail<2>().array() += 1.0 / (tilt * tilt);
  const Matrix5d P = free.inverse();
  const Eigen::Matrix<double, kCameraErrors, 5> gain = H.topRightCorner<5, kCameraErrors>().transpose() * P;
  return {H.bottomRightCorner<kCameraErrors, kCameraErrors>() - gain * H.topRightCorner<5, kCameraErrors>(),
          g.tail<kCameraErrors>() - gain * g.head<5>(), -P.topRows<3>() * g.head<5>(),
          -gain.leftCols<3>().transpose(), P.topLeftCorner<3, 3>()};
}

/// Marginalizes a common shift and turn of the memory, which bounds its information about the pose.
void RobustLikelihood::marginalizeMemoryShift(Curvature& memory) const {
  if (params_.memory_shift_m <= 0.0 && params_.memory_turn_rad <= 0.0) return;
  const double shift = std::max(params_.memory_shift_m, 1e-6);
  const double turn = std::max(params_.memory_turn_rad, 1e-6);
  const Eigen::Vector3d known(1.0 / (shift * shift), 1.0 / (shift * shift), 1.0 / (turn * turn));
  const Eigen::Matrix3d H = memory.H.topLeftCorner<3, 3>();
  // Schur complement of a shift with the same Jacobian as the pose.
  const Eigen::Matrix3d kept =
      Eigen::Matrix3d::Identity() - H * (H + Eigen::Matrix3d(known.asDiagonal())).inverse();
  memory.H.topLeftCorner<3, 3>() = kept * H;
  memory.g.head<3>() = (kept * memory.g.head<3>()).eval();
}

RobustLikelihood::Refined RobustLikelihood::refine(const FloorObservation& observation,
                                                   const Placement& start, const Matrix5d& prior_information,
                                                   double share, int steps, double blur_m,
                                                   const TiltMixture& tilt) const {
  Refined result{start, Matrix5d::Zero(), Matrix5d::Zero(), {}};
  Placement& at = result.placement;
  const double frame_tilt = std::max(params_.frame_tilt_rad, kFixedTilt_rad);
  const Eigen::Matrix2d frame_tilt_information = Eigen::Matrix2d::Identity() / (frame_tilt * frame_tilt);
  const auto frameTiltCovariance = [&](const Matrix5d& H) -> Eigen::Matrix2d {
    return (H.bottomRightCorner<2, 2>() + frame_tilt_information).inverse();
  };
  Blur blur{blur_m};
  const int wide_steps = steps > 0 && blur_m == 0.0 ? kWideSteps : 0;
  if (wide_steps > 0) {
    Matrix5d prior = prior_information + kDamping;
    prior.diagonal().tail<2>().array() += tilt.wideInformation();
    blur.P = prior.inverse();
    blur.P.diagonal().tail<2>().array() += frame_tilt * frame_tilt;
  }
  steps += wide_steps;
  const std::span points(observation.points);
  const std::span remembered = points.first(observation.remembered);
  // One pass more than steps: the last one computes the curvature at the result.
  for (int step = 0; step <= steps; ++step) {
    blur.predicted_share = step < wide_steps ? std::pow(kNarrowing, step) : 0.0;
    Rating* const rating = step == steps ? &result.rating : nullptr;
    Curvature curve;
    if (observation.memory_influence > 0.0 || rating) {
      curve = curvature(remembered, at, observation.memory_influence * share, blur, rating);
      marginalizeMemoryShift(curve);
    }
    const Curvature seen = curvature(points.subspan(observation.remembered), at, share, blur, rating);
    curve.H += seen.H;
    curve.g += seen.g;
    if (rating) {
      const double inliers = curve.inlier_weight + seen.inlier_weight;
      rating->variance_factor = inliers > 0.0 ? (curve.inlier_square + seen.inlier_square) / inliers : 1.0;
    }
    // The frame tilt has the columns of the tilt bias and a prior of its own.
    const Eigen::Matrix<double, 5, 2> cross = curve.H.rightCols<2>();
    const Eigen::Matrix2d frame_tilt_covariance = frameTiltCovariance(curve.H);
    const Eigen::Vector2d frame_tilt_gradient = curve.g.tail<2>() + frame_tilt_information * at.frame_tilt;
    result.information = curve.H - cross * frame_tilt_covariance * cross.transpose();
    if (step == steps) {
      const Eigen::Matrix<double, 5, 2> by_tilt = seen.H.rightCols<2>();
      result.image_information = seen.H - by_tilt * frameTiltCovariance(seen.H) * by_tilt.transpose();
      break;
    }
    Vector5d off;
    off << at.T_world_robot.x - start.T_world_robot.x, at.T_world_robot.y - start.T_world_robot.y,
        angleDifference(at.T_world_robot.theta, start.T_world_robot.theta), at.tilt_bias - start.tilt_bias;
    const double tilt_information =
        step < wide_steps || blur_m > 0.0 ? tilt.wideInformation() : tilt.information(at.tilt_bias);
    Matrix5d A = result.information + prior_information + kDamping;
    A.diagonal().tail<2>().array() += tilt_information;
    Vector5d gradient =
        curve.g - cross * frame_tilt_covariance * frame_tilt_gradient + prior_information * off;
    gradient.tail<2>() += tilt_information * at.tilt_bias;
    Vector5d move = -A.ldlt().solve(gradient);
    const double length = move.head<2>().norm();
    const double shrink = std::min({1.0, kLongestStep_m / std::max(length, 1e-12),
                                    kLongestTurn_rad / std::max(std::abs(move[2]), 1e-12)});
    move *= shrink;
    at.T_world_robot = moved(at.T_world_robot, move.head<3>());
    at.tilt_bias += move.tail<2>();
    at.frame_tilt -= frame_tilt_covariance * (shrink * frame_tilt_gradient + cross.transpose() * move);
    const bool is_small = move.head<2>().norm() < kSmallStep_m && std::abs(move[2]) < kSmallStep_rad;
    if (is_small && step >= wide_steps) steps = step + 1;
  }
  if (!points.empty()) result.rating.explained /= weightOf(observation);
  return result;
}

void LikelihoodParams::visit(ParameterVisitor& v) {
  v.real(expert("OutlierShare", "share of false points in the bounded likelihood"), outlier_share, 1e-6, 0.9);
  v.alias("LeanSway_deg", "CameraTilt.PerFrame_deg");
  v.angle(expert("CameraTilt.PerFrame_deg", "tilt of single images (sigma); 1 for legs"), frame_tilt_rad, 0.0,
          20.0);
  v.real(expert("MemoryShift_m", "shift of the memory as a whole relative to the pose (sigma)"),
         memory_shift_m, 0.0, 10.0);
  v.angle(expert("MemoryTurn_deg", "the same of its heading; 8 for legs"), memory_turn_rad, 0.0, 90.0);
  v.real(expert("ExplainedSigma_m", "least error of a point in the explained share (sigma)"),
         explained_sigma_m, 0.0, 10.0);
}

}  // namespace vismem
