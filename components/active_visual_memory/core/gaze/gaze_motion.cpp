#include "active_visual_memory/core/gaze/gaze_motion.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

// Minimum jerk from rest to rest (Flash and Hogan): s(x) = 10 x^3 - 15 x^4 + 6 x^5. Its peak speed and
// acceleration:
constexpr double kPeakSpeed = 1.875;         // times distance / time, in the middle
constexpr double kPeakAcceleration = 5.774;  // times distance / time^2

constexpr double kFastestTarget_mps = 3.0;  // a faster motion is a jump to another place
constexpr double kVelocityGain = 0.6;
constexpr double kRestAfter_s = 0.4;  // a place unchanged for this long rests
constexpr double kFarthest_s = 0.3;   // horizon of the prediction

double share(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

}  // namespace

double fastestTurn_s(double angle_rad, const AxisLimits& limits) {
  const double angle = std::abs(angle_rad);
  const double v = limits.rate_radps;
  const double a = limits.acceleration_radps2;
  return angle < v * v / a ? 2.0 * std::sqrt(angle / a) : angle / v + v / a;
}

double smoothestTurn_s(double angle_rad, const AxisLimits& limits) {
  const double angle = std::abs(angle_rad);
  return std::max(kPeakSpeed * angle / limits.rate_radps,
                  std::sqrt(kPeakAcceleration * angle / limits.acceleration_radps2));
}

Saccade::Saccade(StampUs start_us, const PanTilt& from, const PanTilt& to, const AxisLimits& pan,
                 const AxisLimits& tilt, double max_slowdown)
    : start_us_(start_us), from_(from) {
  const auto time = [&](double angle, const AxisLimits& limits) {
    const double smooth = smoothestTurn_s(angle, limits);
    const double fast = fastestTurn_s(angle, limits);
    return smooth <= max_slowdown * fast ? smooth : fast;
  };
  const double pan_angle = to.pan_rad - from.pan_rad;
  const double tilt_angle = to.tilt_rad - from.tilt_rad;
  // Both axes arrive together: the slower one sets the duration.
  duration_s_ = std::max(time(pan_angle, pan), time(tilt_angle, tilt));
  smooth_pan_ = smoothestTurn_s(pan_angle, pan) <= duration_s_ + 1e-9;
  smooth_tilt_ = smoothestTurn_s(tilt_angle, tilt) <= duration_s_ + 1e-9;
}

PanTilt Saccade::at(StampUs stamp_us, const PanTilt& to) const {
  const double x = duration_s_ > 0.0 ? toSeconds(stamp_us - start_us_) / duration_s_ : 1.0;
  const double s = share(x);
  return {smooth_pan_ ? from_.pan_rad + s * (to.pan_rad - from_.pan_rad) : to.pan_rad,
          smooth_tilt_ ? from_.tilt_rad + s * (to.tilt_rad - from_.tilt_rad) : to.tilt_rad};
}

void TargetMotion::observe(std::uint64_t id, const Eigen::Vector3d& p_odom, StampUs stamp_us) {
  if (!known_ || id != id_ || stamp_us < seen_us_) {
    *this = TargetMotion{};
    known_ = true;
    id_ = id;
    p_odom_ = p_odom;
    moved_us_ = seen_us_ = stamp_us;
    return;
  }
  seen_us_ = stamp_us;
  if (p_odom == p_odom_) {
    if (toSeconds(stamp_us - moved_us_) > kRestAfter_s) velocity_mps_.setZero();
    return;
  }
  const double dt = toSeconds(stamp_us - moved_us_);
  const Eigen::Vector3d step = p_odom - p_odom_;
  if (dt <= 0.0 || dt > kRestAfter_s || step.norm() > kFastestTarget_mps * dt) {
    velocity_mps_.setZero();
  } else {
    velocity_mps_ += kVelocityGain * (step / dt - velocity_mps_);
  }
  p_odom_ = p_odom;
  moved_us_ = stamp_us;
}

Eigen::Vector3d TargetMotion::at(StampUs stamp_us) const {
  const double dt = std::clamp(toSeconds(stamp_us - moved_us_), 0.0, kFarthest_s);
  return p_odom_ + dt * velocity_mps_;
}

}  // namespace vismem
