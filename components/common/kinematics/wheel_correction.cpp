#include "common/kinematics/wheel_correction.h"

#include <cmath>

#include "common/kinematics/kinematics.h"

namespace vismem {

WheelTravel travelBetween(const Pose2& from, const Pose2& to, double base_m) {
  const Pose2 motion = inverse(from) * to;
  const double half = 0.5 * motion.theta;
  // Along the chord's direction, with its sign: the robot may go backwards.
  const double chord = motion.x * std::cos(half) + motion.y * std::sin(half);
  const double ratio = std::abs(half) < 1e-6 ? 1.0 : half / std::sin(half);
  const double travel = chord * ratio;
  const double turned = 0.5 * base_m * motion.theta;
  return {travel - turned, travel + turned};
}

WheelCorrectionParams inverse(const WheelCorrectionParams& correction) {
  const WheelModel& m = correction.model;
  return {{1.0 / m.left_scale, 1.0 / m.right_scale, correction.reported_base_m},
          m.base_m,
          -correction.delay_us};
}

OdometrySample WheelCorrection::corrected(const OdometrySample& reported) {
  OdometrySample sample = reported;
  sample.stamp_us -= params_.delay_us;
  if (params_.hasReportedWheels()) return sample;
  const WheelModel& m = params_.model;
  const double base = params_.reported_base_m;
  if (!reported_ || reported.seq < reported_->seq) {
    pose_ = reported.T_odom_robot;
  } else {
    const WheelTravel step = travelBetween(reported_->T_odom_robot, reported.T_odom_robot, base);
    const double left = m.left_scale * step.left;
    const double right = m.right_scale * step.right;
    pose_ = pose_ * arcMotion(0.5 * (left + right), (right - left) / m.base_m, 1.0);
  }
  reported_ = reported;
  sample.T_odom_robot = pose_;
  const double left = m.left_scale * (reported.v_mps - 0.5 * base * reported.w_radps);
  const double right = m.right_scale * (reported.v_mps + 0.5 * base * reported.w_radps);
  sample.v_mps = 0.5 * (left + right);
  sample.w_radps = (right - left) / m.base_m;
  return sample;
}

}  // namespace vismem
