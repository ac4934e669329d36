#include "localization/core/likelihood/camera_calibration.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kLongestPause_s = 0.5;  // between two images whose difference is a motion
/// Weight of an image falls to 1/e after this number of images: a camera that is knocked is found again.
constexpr double kRemembered = 600.0;
/// Share of an image's evidence that is independent of the images before.
constexpr double kIndependent = 0.5;
/// Floor points farther away lie near the horizon of some perturbed view [m].
constexpr double kFarthest_m = 50.0;
constexpr double kCameraBlur_m = 0.05;  // a wrong camera moves points by more than their sigmas
constexpr int kSteps = 3;
/// Information about the lasting tilt of a race, which is one of the errors here.
constexpr double kFixedTilt = 1e8;
/// Prior log odds of an error against none, in the order of CameraErrors::Error. Of a delay 1 to 1: the stamp
/// of an image is rarely that of its exposure.
const double kRare = std::log(kUncalibratedOdds);
const CameraVector kLogOdds{{kRare, kRare, kRare, kRare, kRare, kRare, std::log(1.0)}};
/// Least factor of a fitted pose's covariance. The factor is the mean of d²/sigma² of its points, because
/// their errors are far smaller than the blur.
constexpr double kLeastVarianceFactor = 0.01;
/// An error is found from this probability on, and given up below the other one.
constexpr double kFound = 0.95;
constexpr double kGivenUp = 0.5;
/// Prior standard deviations, in the order of CameraErrors::Error.
const CameraVector kPrior{{0.03, 0.03, degToRad(1.0), degToRad(1.0), degToRad(1.0), degToRad(1.0), 0.05}};
constexpr double kStep = 1e-4;  // of the derivatives

}  // namespace

CameraCalibration::CameraCalibration(const RobustLikelihood& likelihood, const MapIndex& map,
                                     const ObservationParams& params, const OdometryNoise& odometry)
    : likelihood_(likelihood), map_(map), params_(params), odometry_(odometry) {
  const CameraVector odds = kLogOdds.array().exp();
  const CameraVector inclusion = odds.array() / (1.0 + odds.array());
  P_.diagonal() = inclusion.cwiseProduct(kPrior.cwiseAbs2());
}

void CameraCalibration::begin(const ImageAnalysis& analysis) {
  const double since_s = static_cast<double>(analysis.stamp_us - stamp_us_) / kSecondUs;
  T_odom_camera_before_ = T_odom_robot_ * configured_.T_robot_camera;
  since_before_s_ = since_s > 0.0 && since_s <= kLongestPause_s ? since_s : 0.0;
  configured_ = {analysis.intrinsics, analysis.T_robot_camera};
  T_odom_robot_ = toPose3(analysis.T_odom_robot);
  stamp_us_ = analysis.stamp_us;
}

std::optional<CameraModel> CameraCalibration::corrected() const {
  if (errors_.sigmas.isZero()) return std::nullopt;
  return view(errors_.errors);
}

CameraModel CameraCalibration::view(const CameraVector& errors) const {
  CameraModel view = configured_;
  if (since_before_s_ > 0.0) {
    const Pose3 T_odom_camera = T_odom_robot_ * configured_.T_robot_camera;
    const double back = errors[CameraErrors::kDelay] / since_before_s_;
    view.T_robot_camera = T_odom_robot_.inverse() * interpolate(T_odom_camera, T_odom_camera_before_, back);
  }
  view.T_robot_camera.translation().z() += errors[CameraErrors::kHeight];
  const auto turn = [&](CameraErrors::Error error, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(errors[error], axis).toRotationMatrix();
  };
  view.T_robot_camera.linear() = turn(CameraErrors::kMountPitch, Eigen::Vector3d::UnitY()) *
                                 turn(CameraErrors::kMountRoll, Eigen::Vector3d::UnitX()) *
                                 view.T_robot_camera.linear() *
                                 turn(CameraErrors::kPitch, Eigen::Vector3d::UnitX()) *
                                 turn(CameraErrors::kRoll, Eigen::Vector3d::UnitZ());
  view.intrinsics.fx *= 1.0 + errors[CameraErrors::kFocal];
  view.intrinsics.fy *= 1.0 + errors[CameraErrors::kFocal];
  return view;
}

/// Derivatives of the observation's points by the errors [m per unit of CameraErrors].
void CameraCalibration::differentiate(const CameraModel& here) {
  std::array<CameraModel, kCameraErrors> perturbed;
  for (int i = 0; i < kCameraErrors; ++i) {
    perturbed[static_cast<std::size_t>(i)] = view(errors_.errors + kStep * CameraVector::Unit(i));
  }
  const Pose3 T_camera_robot = here.T_robot_camera.inverse();
  derivatives_.clear();
  for (const FloorPoint& point : observation_.points) {
    const Eigen::Vector2d& p = point.p_robot;
    CameraJacobian& d = derivatives_.emplace_back(CameraJacobian::Zero());
    const auto px = projectToIdeal(here.intrinsics, T_camera_robot * Eigen::Vector3d(p.x(), p.y(), 0.0));
    if (!px) continue;
    for (int i = 0; i < kCameraErrors; ++i) {
      const CameraModel& there = perturbed[static_cast<std::size_t>(i)];
      const auto floor = backProjectToGround(there.intrinsics, there.T_robot_camera, *px, kFarthest_m);
      if (floor) d.col(i) = (floor->head<2>() - p) / kStep;
    }
  }
}

Eigen::Vector2d CameraCalibration::fit(const ImageAnalysis& analysis, const Placement& placement,
                                       bool is_trusted) {
  const CameraModel here = view(errors_.errors);
  seen_ = observeImage(analysis, map_, params_, &here, std::move(seen_));
  observation_ = thinned(seen_, kMaximumPoints, std::move(observation_));
  if (observation_.points.empty()) return Eigen::Vector2d::Zero();
  Matrix5d prior = Matrix5d::Identity();
  prior.diagonal().tail<2>().setConstant(kFixedTilt);
  const auto refined = likelihood_.refine(observation_, placement, prior, 1.0, kSteps, kCameraBlur_m);
  differentiate(here);
  const CameraEvidence evidence =
      likelihood_.cameraEvidence(observation_, refined.placement, derivatives_, kCameraBlur_m);
  const FittedPose fitted{analysis.stamp_us,
                          analysis.T_odom_robot,
                          moved(refined.placement.T_world_robot, evidence.step),
                          evidence.d_pose,
                          std::max(kLeastVarianceFactor, refined.rating.variance_factor) * evidence.P_pose,
                          errors_.errors,
                          is_trusted};
  const auto before = std::exchange(fitted_, fitted);
  if (!is_trusted) return Eigen::Vector2d::Zero();
  const double kept = 1.0 - 1.0 / kRemembered;
  information_ = kept * information_ + kIndependent * evidence.information;
  information_vector_ =
      kept * information_vector_ + kIndependent * (evidence.information * errors_.errors - evidence.gradient);
  if (before && before->is_trusted && since_before_s_ > 0.0) compareMotion(*before, fitted);
  estimate();
  const Eigen::AngleAxisd turned(view(errors_.errors).T_robot_camera.linear() *
                                 here.T_robot_camera.linear().transpose());
  return turned.angle() * Eigen::Vector2d(turned.axis().y(), turned.axis().x());
}

double CameraCalibration::tiltSigma() const {
  const CameraVector& sigmas = errors_.sigmas.isZero() ? kPrior : errors_.sigmas;
  return std::max(std::hypot(sigmas[CameraErrors::kPitch], sigmas[CameraErrors::kMountPitch]),
                  std::hypot(sigmas[CameraErrors::kRoll], sigmas[CameraErrors::kMountRoll]));
}

Eigen::Matrix3d CameraCalibration::poseCovariance() const {
  if (!fitted_) return Eigen::Matrix3d::Zero();
  return fitted_->d_errors * P_ * fitted_->d_errors.transpose();
}

/// Odometry says by how much two fitted poses must differ.
void CameraCalibration::compareMotion(const FittedPose& before, const FittedPose& now) {
  const StampUs between_us = now.stamp_us - before.stamp_us;
  if (between_us <= 0 || between_us > toStampUs(kLongestPause_s)) return;
  const Pose2 motion = inverse(before.T_odom_robot) * now.T_odom_robot;
  const Pose2 predicted = before.T_world_robot * motion;
  const Eigen::Vector2d shift = predicted.position() - before.T_world_robot.position();
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.block<2, 1>(0, 2) << -shift.y(), shift.x();
  const Eigen::Vector3d residual{now.T_world_robot.x - predicted.x, now.T_world_robot.y - predicted.y,
                                 angleDifference(now.T_world_robot.theta, predicted.theta)};
  const PoseJacobian J = now.d_errors - F * before.d_errors;
  Eigen::Matrix3d P = now.P + F * before.P * F.transpose();
  P.diagonal() += odometry_.variances(shift.norm(), std::abs(motion.theta));
  const Eigen::Matrix3d information = P.inverse();
  const Eigen::Vector3d without = residual - now.d_errors * now.errors + F * before.d_errors * before.errors;
  const Eigen::Vector3d left = without + J * now.errors;
  // Cauchy's weight: wheels slip.
  const double weight = kIndependent / (1.0 + left.dot(information * left) / 3.0);
  information_ += weight * J.transpose() * information * J;
  information_vector_ -= weight * J.transpose() * information * without;
}

/// Posterior mean and standard deviations, mixed over all subsets of the errors by their evidence.
void CameraCalibration::estimate() {
  const CameraVector prior = kPrior.cwiseAbs2();
  CameraVector mean = CameraVector::Zero();
  CameraMatrix square = CameraMatrix::Zero();
  CameraVector inclusion = CameraVector::Zero();
  double sum = 0.0;
  double fullest = 0.0;  // log evidence of the first subset, which has all errors and fits best
  for (unsigned subset = 1U << kCameraErrors; subset-- > 0;) {
    CameraVector is_included;
    for (int i = 0; i < kCameraErrors; ++i) is_included[i] = subset >> i & 1U;
    const CameraVector variance = prior.cwiseProduct(is_included);
    const auto lu =
        CameraMatrix(CameraMatrix::Identity() + variance.asDiagonal() * information_).partialPivLu();
    const CameraMatrix P = lu.solve(CameraMatrix(variance.asDiagonal()));
    const CameraVector errors = P * information_vector_;
    const double log_evidence =
        0.5 * (information_vector_.dot(errors) - std::log(lu.determinant())) + kLogOdds.dot(is_included);
    if (sum == 0.0) fullest = log_evidence;
    const double probability = std::exp(log_evidence - fullest);
    sum += probability;
    mean += probability * errors;
    square += probability * (P + errors * errors.transpose());
    inclusion += probability * is_included;
  }
  errors_.errors = mean / sum;
  P_ = square / sum - errors_.errors * errors_.errors.transpose();
  errors_.sigmas = P_.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (int i = 0; i < kCameraErrors; ++i) {
    errors_.found[static_cast<std::size_t>(i)] =
        inclusion[i] > (errors_.isFound(i) ? kGivenUp : kFound) * sum;
  }
}

std::string CameraAlarm::update(const CameraErrors& camera) {
  if (camera.found == named_) return {};
  named_ = camera.found;
  std::string text;
  for (std::size_t i = 0; i < kCameraErrorTexts.size(); ++i) {
    if (!named_[i]) continue;
    const CameraErrorText& is = kCameraErrorTexts[i];
    const auto row = static_cast<int>(i);
    text +=
        (text.empty() ? "" : ", ") + formatted("%s %.1f +- %.1f %s", is.name, is.scale * camera.errors[row],
                                               is.scale * camera.sigmas[row], is.unit);
  }
  return text.empty() ? "the camera is as it is configured, as far as the map shows"
                      : "against the map: " + text + ": run calibrate body";
}

}  // namespace vismem
