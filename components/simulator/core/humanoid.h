/// @file The walk of a humanoid: steps and body sway, as far as they move the camera. Pure.
#pragma once

#include <cstdint>
#include <random>

#include "common/geometry/pose.h"
#include "common/kinematics/kinematics.h"

namespace vismem {

struct WalkParams {
  double step_s = 0.25;  ///< duration of one step; two make a cycle
  /// Share of the speed that varies within a step: 0 is constant speed, 1 stops between steps.
  double pulse = 0.5;
  /// Maximum increase of the speed from step to step [m/s]; a decrease is not limited.
  double step_acceleration_mps = 0.1;
  double step_turn_acceleration_radps = degToRad(30.0);
  // Amplitudes of the sway about the point on the floor below the body:
  double roll_rad = degToRad(1.0);   ///< to each side once in a cycle
  double pitch_rad = degToRad(1.0);  ///< forward and back in every step
  double height_m = 0.005;           ///< down and up in every step
  double lateral_m = 0.01;           ///< towards the standing foot
  /// Standard deviation of the sway of single steps, relative to the amplitudes (cut at 0 and twice).
  double irregularity = 0.2;
  /// Share of the sway that the robot's own kinematics include, 0..1.
  double known = 0.0;
};

/// Offset of the body from its nominal pose above the robot's origin.
struct BodyPosture {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double height_m = 0.0;
  double lateral_m = 0.0;
};
/// Pose of the swaying body in the robot frame; the body turns about the robot's origin.
/// @param share of it.
Pose3 bodyPose(const BodyPosture& posture, double share = 1.0);
BodyPosture interpolate(const BodyPosture& from, const BodyPosture& to, double fraction);

/// Converts commanded speeds into those of a walk. Speeds change from step to step only; a stop takes effect
/// at the end of the step. *Single-threaded*. The same seed and commands give the same walk.
class HumanoidWalk {
 public:
  HumanoidWalk(const WalkParams& params, std::uint64_t seed);

  /// @param wanted commanded speeds within the base's limits.
  /// @return the speeds over the next dt_s.
  BaseSpeeds step(const BaseSpeeds& wanted, double dt_s);
  /// Posture at the end of the last step.
  BodyPosture posture() const;
  bool walking() const { return walking_; }
  const WalkParams& params() const { return params_; }

 private:
  void beginStep(const BaseSpeeds& wanted);

  WalkParams params_;
  std::mt19937_64 engine_;
  bool walking_ = false;
  double phase_ = 0.0;  ///< of the step, 0..1
  double side_ = 1.0;   ///< standing foot: 1 left, -1 right
  double roll_scale_ = 1.0;
  double pitch_scale_ = 1.0;
  BaseSpeeds speeds_;  ///< means of this step
};

}  // namespace vismem
