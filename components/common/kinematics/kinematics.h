/// @file Motion of a simulated robot: differential base, pan-tilt unit, wheel odometry. Pure: the simulator
/// and the drivers base_simulated and pantilt_simulated move by it. DESIGN 6.
#pragma once

#include <random>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/kinematics/obstacle.h"
#include "common/robot/ports.h"

namespace vismem {

struct BaseParams {
  BaseLimits limits{0.6, degToRad(100.0), 0.5};
  double acceleration_mps2 = 0.8;
  double turn_acceleration_radps2 = degToRad(300.0);
  double radius_m = 0.22;      ///< of the round body, for collisions
  double wheel_base_m = 0.33;  ///< between the wheels
};

/// Where wheel odometry goes wrong. Errors are of the wheels, not of the pose: no filter assumes them (DESIGN
/// 6).
struct OdometryErrorParams {
  double radius_sigma = 0.0;        ///< relative error of each wheel's radius, drawn once per run
  double base_sigma = 0.0;          ///< relative error of the wheel base, drawn once per run
  double travel_sigma_sqrtm = 0.0;  ///< standard deviation of a wheel's noise after one metre [m]
  double tick_m = 0.0;              ///< travel of a wheel per encoder tick; 0: no quantisation
};
OdometryErrorParams noOdometryError();
/// Radii within 0.5 %, base within 1 %, 5 mm after a metre, ticks of 0.2 mm.
OdometryErrorParams defaultOdometryError();

/// The travel of both wheels in one step [m].
struct WheelTravel {
  double left = 0.0;
  double right = 0.0;
};

/// True motion of a round differential-drive robot among obstacles. *Single-threaded*.
class SimulatedBase {
 public:
  SimulatedBase(const BaseParams& params, const Pose2& T_world_robot, std::vector<WorldObstacle> obstacles);

  /// Takes effect at once; forgotten when limits().watchdog_s passed without another. Must be finite.
  void command(double v_mps, double w_radps, StampUs now_us);
  /// One step of exact arc motion. A step into an obstacle is not made: the robot stops there.
  WheelTravel step(StampUs now_us, double dt_s);
  void place(const Pose2& T_world_robot);
  bool collidesAt(const Pose2& T_world_robot) const;

  const Pose2& pose() const { return pose_; }
  double speed() const { return v_; }
  double turnRate() const { return w_; }
  bool inCollision() const { return in_collision_; }
  const BaseParams& params() const { return params_; }

 private:
  BaseParams params_;
  Pose2 pose_;
  std::vector<WorldObstacle> obstacles_;
  double wanted_v_ = 0.0;
  double wanted_w_ = 0.0;
  StampUs command_us_ = 0;
  double v_ = 0.0;
  double w_ = 0.0;
  bool in_collision_ = false;
};

/// Pose by adding up wheel ticks, with the wheels' errors. *Single-threaded*.
class SimulatedOdometry {
 public:
  SimulatedOdometry(const OdometryErrorParams& errors, double wheel_base_m, std::uint64_t seed);
  void add(const WheelTravel& travel);
  const Pose2& pose() const { return pose_; }

 private:
  /// Travel in whole ticks; the rest waits for the next step.
  double quantise(double travel, double& rest) const;

  OdometryErrorParams errors_;
  double left_scale_;
  double right_scale_;
  double wheel_base_m_;
  double left_rest_ = 0.0;
  double right_rest_ = 0.0;
  Pose2 pose_;
  std::mt19937_64 engine_;
};

struct PanTiltParams {
  PanTiltLimits limits{degToRad(-159.0), degToRad(159.0), degToRad(-31.0),
                       degToRad(31.0),   degToRad(150.0), degToRad(150.0)};
  double acceleration_radps2 = degToRad(1000.0);
};

/// Two joints with limits of angle, rate and acceleration. *Single-threaded*.
class SimulatedPanTilt {
 public:
  explicit SimulatedPanTilt(const PanTiltParams& params) : params_(params) {}
  /// Adjusted to the limits; must be finite.
  void command(const PanTiltCommand& command);
  void step(double dt_s);
  PanTilt angles() const { return {pan_.angle, tilt_.angle}; }
  const PanTiltParams& params() const { return params_; }

 private:
  struct Joint {
    double angle = 0.0;
    double rate = 0.0;
    bool to_position = false;
    double wanted = 0.0;    ///< angle or rate
    double max_rate = 0.0;  ///< on the way to a position
  };
  void stepJoint(Joint& joint, double low, double high, double dt_s) const;

  PanTiltParams params_;
  Joint pan_;
  Joint tilt_;
};

/// The motion of a unicycle over dt with constant speeds: an exact arc.
Pose2 arcMotion(double v_mps, double w_radps, double dt_s);

}  // namespace vismem
