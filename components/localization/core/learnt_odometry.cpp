#include "localization/core/learnt_odometry.h"

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

enum Error { kTurnPerMetre = 0, kTurnShare = 1, kTravelShare = 2 };

}  // namespace

LearntOdometry::LearntOdometry(const LearntOdometryParams& params) : params_(params) {
  const Eigen::Vector3d std(params.turn_per_m, params.turn_share, params.travel_share);
  belief_.P = std.cwiseProduct(std).asDiagonal();
}

Pose2 LearntOdometry::corrected(const Pose2& T_before_now) const {
  const double turn =
      belief_.errors[kTurnPerMetre] * T_before_now.x + belief_.errors[kTurnShare] * T_before_now.theta;
  const double scale = 1.0 + belief_.errors[kTravelShare];
  // What it turned more it turned on the way: on average half of it.
  const Eigen::Vector2d way =
      transform(Pose2{0.0, 0.0, 0.5 * turn}, Eigen::Vector2d(scale * T_before_now.position()));
  return {way.x(), way.y(), wrapAngle(T_before_now.theta + turn)};
}

void LearntOdometry::travel(const Pose2& T_before_now) {
  if (!start_) return;
  moved_ = moved_ * T_before_now;
  turned_ += T_before_now.theta;
  forward_ += T_before_now.x;
  travelled_ += T_before_now.position().norm();
  swung_ += std::abs(T_before_now.theta);
}

void LearntOdometry::begin(const Pose2& T_world_robot, std::uint64_t id) {
  start_ = Start{id, T_world_robot};
  moved_ = {};
  turned_ = forward_ = travelled_ = swung_ = 0.0;
}

void LearntOdometry::standsAt(const Pose2& T_world_robot, std::uint64_t id) {
  if (!start_ || start_->id != id) return begin(T_world_robot, id);
  if (travelled_ < params_.piece_m && swung_ < params_.piece_rad) return;
  const Pose2 T_start_now = inverse(start_->T_world_robot) * T_world_robot;
  const double ends_rad2 = 2.0 * params_.pose_std_rad * params_.pose_std_rad;
  const double ends_m2 = 2.0 * params_.pose_std_m * params_.pose_std_m;
  const double noise_rad2 = params_.noise_rad_per_root_m * params_.noise_rad_per_root_m * travelled_ +
                            params_.noise_rad_per_root_rad * params_.noise_rad_per_root_rad * swung_;
  take(angleDifference(T_start_now.theta, moved_.theta), {forward_, turned_, 0.0}, ends_rad2 + noise_rad2);
  const double chord = moved_.position().norm();
  if (chord > 0.5 * params_.piece_m) {
    const double noise_m2 = params_.noise_m_per_root_m * params_.noise_m_per_root_m * travelled_;
    take(T_start_now.position().norm() - chord, {0.0, 0.0, chord}, ends_m2 + noise_m2);
  }
  const Eigen::Vector3d walk =
      params_.walk_share * Eigen::Vector3d(params_.turn_per_m, params_.turn_share, params_.travel_share);
  belief_.P.diagonal() += walk.cwiseProduct(walk) * travelled_;
  begin(T_world_robot, id);
}

void LearntOdometry::take(double z, const Eigen::RowVector3d& H, double variance) {
  const double innovation = z - H * belief_.errors;
  const double s = H * belief_.P * H.transpose() + variance;
  // A wheel that slipped, a robot that was pushed or carried: none of that goes on.
  if (innovation * innovation > params_.gate_sigmas * params_.gate_sigmas * s) return;
  const Eigen::Vector3d gain = belief_.P * H.transpose() / s;
  belief_.errors += gain * innovation;
  belief_.P -= gain * H * belief_.P;
  belief_.P = 0.5 * (belief_.P + belief_.P.transpose()).eval();
}

}  // namespace vismem
