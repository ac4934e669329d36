#include "common/kinematics/kinematics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/segment.h"

namespace vismem {
namespace {

double towards(double value, double wanted, double max_change) {
  return value + std::clamp(wanted - value, -max_change, max_change);
}

}  // namespace

double distanceToOutline(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& outline) {
  bool inside = true;
  double nearest = 1e9;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Segment2 side{outline[i], outline[(i + 1) % outline.size()]};
    const Eigen::Vector2d d = side.b - side.a;
    const Eigen::Vector2d ap = p - side.a;
    inside = inside && cross2(d, ap) >= 0.0;
    nearest = std::min(nearest, distanceToSegment(p, side));
  }
  return inside ? 0.0 : nearest;
}

Pose2 arcMotion(double v_mps, double w_radps, double dt_s) {
  const double turn = w_radps * dt_s;
  const double travel = v_mps * dt_s;
  constexpr double kStraight_rad = 1e-9;
  if (std::abs(turn) < kStraight_rad) return {travel, 0.0, turn};
  const double radius = travel / turn;
  return {radius * std::sin(turn), radius * (1.0 - std::cos(turn)), turn};
}

SimulatedBase::SimulatedBase(const BaseParams& params, const Pose2& T_world_robot,
                             std::vector<WorldObstacle> obstacles)
    : params_(params), pose_(T_world_robot), obstacles_(std::move(obstacles)) {}

void SimulatedBase::command(double v_mps, double w_radps, StampUs now_us) {
  const BaseLimits& limits = params_.limits;
  wanted_ = {std::clamp(v_mps, -limits.max_speed_mps, limits.max_speed_mps),
             std::clamp(w_radps, -limits.max_turn_rate_radps, limits.max_turn_rate_radps)};
  command_us_ = now_us;
  halted_ = false;
}

bool SimulatedBase::collidesAt(const Pose2& pose) const {
  return std::any_of(obstacles_.begin(), obstacles_.end(), [&](const WorldObstacle& obstacle) {
    return distanceToOutline(pose.position(), obstacle.outline) < params_.radius_m;
  });
}

bool SimulatedBase::timedOut(StampUs now_us) const {
  return halted_ || toSeconds(now_us - command_us_) > params_.limits.watchdog_s;
}

BaseSpeeds SimulatedBase::wanted(StampUs now_us) const {
  return timedOut(now_us) ? BaseSpeeds{} : wanted_;
}

WheelTravel SimulatedBase::step(StampUs now_us, double dt_s) {
  const BaseSpeeds speeds = wanted(now_us);
  const bool emergency = timedOut(now_us);
  const double a = emergency ? params_.emergency_deceleration_mps2 : params_.acceleration_mps2;
  const double turn_a =
      emergency ? params_.emergency_turn_deceleration_radps2 : params_.turn_acceleration_radps2;
  return moveAt({towards(v_, speeds.v_mps, a * dt_s), towards(w_, speeds.w_radps, turn_a * dt_s)}, dt_s);
}

WheelTravel SimulatedBase::moveAt(const BaseSpeeds& speeds, double dt_s) {
  v_ = speeds.v_mps;
  w_ = speeds.w_radps;
  in_collision_ = v_ != 0.0 && collidesAt(pose_ * arcMotion(v_, w_, dt_s));
  if (in_collision_) v_ = 0.0;  // a round robot may still turn on the spot
  pose_ = pose_ * arcMotion(v_, w_, dt_s);
  const double half_base = 0.5 * params_.wheel_base_m;
  return {(v_ - w_ * half_base) * dt_s, (v_ + w_ * half_base) * dt_s};
}

void SimulatedBase::place(const Pose2& T_world_robot) {
  pose_ = T_world_robot;
  v_ = w_ = 0.0;
  wanted_ = {};
}

void SimulatedPanTilt::command(const PanTiltCommand& command) {
  const PanTiltLimits& limits = params_.limits;
  const auto set = [&](Joint& joint, double angle, double rate, double low, double high, double max_rate) {
    joint.to_position = command.kind == PanTiltCommand::Kind::kPosition;
    if (joint.to_position) {
      joint.wanted = std::clamp(angle, low, high);
      joint.max_rate = rate > 0.0 ? std::min(rate, max_rate) : max_rate;
    } else {
      joint.wanted = std::clamp(rate, -max_rate, max_rate);
    }
  };
  set(pan_, command.pan_rad, command.pan_rate_radps, limits.min_pan_rad, limits.max_pan_rad,
      limits.max_pan_rate_radps);
  set(tilt_, command.tilt_rad, command.tilt_rate_radps, limits.min_tilt_rad, limits.max_tilt_rad,
      limits.max_tilt_rate_radps);
}

void SimulatedPanTilt::halt() {
  for (Joint* joint : {&pan_, &tilt_}) {
    joint->to_position = false;
    joint->rate = joint->wanted = 0.0;
  }
}

void SimulatedPanTilt::stepJoint(Joint& joint, double low, double high, double backlash, double dt_s) const {
  const double a = params_.acceleration_radps2;
  double rate = joint.wanted;
  if (joint.to_position) {
    // The fastest rate from which the joint can still stop at the target, one step of reaction included.
    const double gap = joint.wanted - joint.angle;
    const double stopping = std::sqrt(2.0 * a * std::abs(gap) + 0.25 * a * a * dt_s * dt_s) - 0.5 * a * dt_s;
    rate = std::copysign(std::min({joint.max_rate, stopping, std::abs(gap) / dt_s}), gap);
  }
  joint.rate = towards(joint.rate, rate, a * dt_s);
  joint.angle += joint.rate * dt_s;
  if (joint.angle < low || joint.angle > high) {
    joint.angle = std::clamp(joint.angle, low, high);
    joint.rate = 0.0;
  }
  joint.head = std::clamp(joint.head, joint.angle - 0.5 * backlash, joint.angle + 0.5 * backlash);
}

void SimulatedPanTilt::step(double dt_s) {
  const PanTiltLimits& limits = params_.limits;
  const PanTilt& backlash = params_.backlash_rad;
  stepJoint(pan_, limits.min_pan_rad, limits.max_pan_rad, backlash.pan_rad, dt_s);
  stepJoint(tilt_, limits.min_tilt_rad, limits.max_tilt_rad, backlash.tilt_rad, dt_s);
}

}  // namespace vismem
