#include "simulator/core/humanoid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

/// The next step's speed: a decrease down to 0 is not limited, an increase is at most `gain`.
double nextSpeed(double now, double wanted, double gain) {
  const double kept = now * wanted > 0.0 ? std::abs(now) : 0.0;
  return std::copysign(std::min(std::abs(wanted), kept + gain), wanted);
}

}  // namespace

Pose3 bodyPose(const BodyPosture& p, double share) {
  return poseFromXyzRpy(0.0, share * p.lateral_m, share * p.height_m, share * p.roll_rad, share * p.pitch_rad,
                        0.0);
}

BodyPosture interpolate(const BodyPosture& from, const BodyPosture& to, double fraction) {
  const auto between = [fraction](double a, double b) { return a + fraction * (b - a); };
  return {between(from.roll_rad, to.roll_rad), between(from.pitch_rad, to.pitch_rad),
          between(from.height_m, to.height_m), between(from.lateral_m, to.lateral_m)};
}

HumanoidWalk::HumanoidWalk(const WalkParams& params, std::uint64_t seed) : params_(params), engine_(seed) {}

void HumanoidWalk::beginStep(const BaseSpeeds& wanted) {
  speeds_ = {nextSpeed(speeds_.v_mps, wanted.v_mps, params_.step_acceleration_mps),
             nextSpeed(speeds_.w_radps, wanted.w_radps, params_.step_turn_acceleration_radps)};
  walking_ = speeds_.v_mps != 0.0 || speeds_.w_radps != 0.0;
  phase_ = 0.0;
  if (!walking_) return;
  side_ = -side_;
  std::normal_distribution<double> normal(1.0, params_.irregularity);
  roll_scale_ = std::clamp(normal(engine_), 0.0, 2.0);
  pitch_scale_ = std::clamp(normal(engine_), 0.0, 2.0);
}

BaseSpeeds HumanoidWalk::step(const BaseSpeeds& wanted, double dt_s) {
  if (!walking_) beginStep(wanted);
  if (!walking_) return {};
  // The integral of the pulse over [phase, phase + d]: the length of a step does not depend on dt.
  const double from = phase_;
  const double to = std::min(1.0, phase_ + dt_s / params_.step_s);
  const double covered =
      (to - from) - params_.pulse * (std::sin(2.0 * kPi * to) - std::sin(2.0 * kPi * from)) / (2.0 * kPi);
  const double share = covered * params_.step_s / dt_s;
  const BaseSpeeds now{speeds_.v_mps * share, speeds_.w_radps * share};
  phase_ = to;
  constexpr double kDone = 1.0 - 1e-9;
  if (phase_ >= kDone) beginStep(wanted);
  return now;
}

BodyPosture HumanoidWalk::posture() const {
  if (!walking_) return {};
  const double once = std::sin(kPi * phase_);
  return {side_ * roll_scale_ * params_.roll_rad * once,
          pitch_scale_ * params_.pitch_rad * std::sin(2.0 * kPi * phase_),
          -0.5 * params_.height_m * (1.0 - std::cos(2.0 * kPi * phase_)),
          side_ * roll_scale_ * params_.lateral_m * once};
}

}  // namespace vismem
