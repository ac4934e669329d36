#include "localization/core/odometry_calibration.h"

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kPiece_m = 0.5;  // a measurement covers this distance or this turn
constexpr double kPiece_rad = 0.8;
constexpr double kPoseStd_rad = degToRad(0.5);  // of a reference pose
constexpr double kNoise_rad_per_root_m = 0.03;  // random errors of odometry
constexpr double kNoise_rad_per_root_rad = 0.02;
constexpr double kGateSigmas = 3.0;  // measurements with a larger innovation are rejected

enum Error { kTurnPerMetre = 0, kTurnShare = 1 };

}  // namespace

OdometryCalibration::OdometryCalibration(const OdometryCalibrationParams& params) : params_(params) {
  const Eigen::Vector3d std(params.turn_per_m, params.turn_share, 0.0);
  bias_.P = std.cwiseProduct(std).asDiagonal();
}

Pose2 OdometryCalibration::corrected(const Pose2& T_before_now) const {
  const double turn =
      bias_.errors[kTurnPerMetre] * T_before_now.x + bias_.errors[kTurnShare] * T_before_now.theta;
  // The additional turn happens along the way: on average half of it rotates the translation.
  const Eigen::Vector2d way = transform(Pose2{0.0, 0.0, 0.5 * turn}, T_before_now.position());
  return {way.x(), way.y(), wrapAngle(T_before_now.theta + turn)};
}

void OdometryCalibration::addMotion(const Pose2& T_before_now) {
  if (!start_) return;
  moved_ = moved_ * T_before_now;
  turned_ += T_before_now.theta;
  forward_ += T_before_now.x;
  travelled_ += T_before_now.position().norm();
  swung_ += std::abs(T_before_now.theta);
}

void OdometryCalibration::begin(const Pose2& T_world_robot, std::uint64_t id) {
  start_ = Start{id, T_world_robot};
  moved_ = {};
  turned_ = forward_ = travelled_ = swung_ = 0.0;
}

void OdometryCalibration::addReferencePose(const Pose2& T_world_robot, std::uint64_t id) {
  if (!start_ || start_->id != id) return begin(T_world_robot, id);
  if (travelled_ < kPiece_m && swung_ < kPiece_rad) return;
  const Pose2 T_start_now = inverse(start_->T_world_robot) * T_world_robot;
  const double ends_rad2 = 2.0 * kPoseStd_rad * kPoseStd_rad;
  const double noise_rad2 = kNoise_rad_per_root_m * kNoise_rad_per_root_m * travelled_ +
                            kNoise_rad_per_root_rad * kNoise_rad_per_root_rad * swung_;
  update(angleDifference(T_start_now.theta, moved_.theta), {forward_, turned_}, ends_rad2 + noise_rad2);
  const Eigen::Vector3d walk =
      params_.walk_share * Eigen::Vector3d(params_.turn_per_m, params_.turn_share, 0.0);
  bias_.P.diagonal() += walk.cwiseProduct(walk) * travelled_;
  begin(T_world_robot, id);
}

void OdometryCalibration::update(double z, const Eigen::RowVector2d& H_yaw, double variance) {
  const Eigen::RowVector3d H(H_yaw[0], H_yaw[1], 0.0);
  const double innovation = z - H * bias_.errors;
  const double s = H * bias_.P * H.transpose() + variance;
  // Slip, a push or being carried are not lasting errors.
  if (innovation * innovation > kGateSigmas * kGateSigmas * s) return;
  const Eigen::Vector3d gain = bias_.P * H.transpose() / s;
  bias_.errors += gain * innovation;
  bias_.P -= gain * H * bias_.P;
  bias_.P = 0.5 * (bias_.P + bias_.P.transpose()).eval();
}

}  // namespace vismem
