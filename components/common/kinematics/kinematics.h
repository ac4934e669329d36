/// @file Motion of a simulated robot: differential base, pan-tilt unit, wheel odometry. Pure: used by the
/// simulator and the drivers base_simulated and pantilt_simulated.
#pragma once

#include <utility>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/kinematics/obstacle.h"
#include "common/kinematics/odometry.h"
#include "common/robot/ports.h"

namespace vismem {

struct BaseParams {
  BaseLimits limits{0.6, degToRad(100.0), 0.25};
  double acceleration_mps2 = 0.8;
  double turn_acceleration_radps2 = degToRad(300.0);
  /// Decelerations after the watchdog has fired: from full speed the base stops 0.4 s after the last command.
  double emergency_deceleration_mps2 = 4.0;
  double emergency_turn_deceleration_radps2 = degToRad(1000.0);
  double radius_m = 0.22;      ///< of the round body, for collisions
  double wheel_base_m = 0.33;  ///< between the wheels
};

/// Speeds of a base: forward, and turning counter-clockwise.
struct BaseSpeeds {
  double v_mps = 0.0;
  double w_radps = 0.0;
};

/// True motion of a round differential-drive robot among obstacles. *Single-threaded*.
class SimulatedBase {
 public:
  SimulatedBase(const BaseParams& params, const Pose2& T_world_robot, std::vector<WorldObstacle> obstacles);

  /// Takes effect at once and expires after limits().watchdog_s without another command. Must be finite.
  void command(double v_mps, double w_radps, StampUs now_us);
  /// Brakes with the decelerations of the watchdog, and stands until the next command.
  void halt() { halted_ = true; }
  /// Commanded speeds: within the limits, and 0 once the watchdog has fired.
  BaseSpeeds wanted(StampUs now_us) const;
  /// One step of exact arc motion within the accelerations. The robot stops before a step into an obstacle.
  WheelTravel step(StampUs now_us, double dt_s);
  /// As step(), with the given speeds, for example of a gait.
  WheelTravel moveAt(const BaseSpeeds& speeds, double dt_s);
  void place(const Pose2& T_world_robot);
  /// Replaces the obstacles, which may move; the robot stops while one blocks it.
  void setObstacles(std::vector<WorldObstacle> obstacles) { obstacles_ = std::move(obstacles); }
  bool collidesAt(const Pose2& T_world_robot) const;

  const Pose2& pose() const { return pose_; }
  double speed() const { return v_; }
  double turnRate() const { return w_; }
  bool inCollision() const { return in_collision_; }
  const BaseParams& params() const { return params_; }

 private:
  bool timedOut(StampUs now_us) const;

  BaseParams params_;
  Pose2 pose_;
  std::vector<WorldObstacle> obstacles_;
  BaseSpeeds wanted_;
  StampUs command_us_ = 0;
  bool halted_ = false;
  double v_ = 0.0;
  double w_ = 0.0;
  bool in_collision_ = false;
};

struct PanTiltParams {
  PanTiltLimits limits{degToRad(-159.0), degToRad(159.0), degToRad(-31.0),
                       degToRad(31.0),   degToRad(150.0), degToRad(150.0)};
  double acceleration_radps2 = degToRad(1000.0);
  PanTilt backlash_rad{0.0, 0.0};  ///< play between the motors, whose angles are reported, and the head
};

/// Two joints with limits of angle, rate and acceleration, and with backlash. *Single-threaded*.
class SimulatedPanTilt {
 public:
  explicit SimulatedPanTilt(const PanTiltParams& params) : params_(params) {}
  /// Adjusted to the limits; must be finite.
  void command(const PanTiltCommand& command);
  void step(double dt_s);
  /// Stops at once, until the next command.
  void halt();
  /// Of the motors: as encoders report them.
  PanTilt angles() const { return {pan_.angle, tilt_.angle}; }
  /// Of the head, which follows a motor that has crossed the backlash.
  PanTilt headAngles() const { return {pan_.head, tilt_.head}; }
  const PanTiltParams& params() const { return params_; }

 private:
  struct Joint {
    double angle = 0.0;
    double head = 0.0;  ///< angle behind the backlash
    double rate = 0.0;
    bool to_position = false;
    double wanted = 0.0;    ///< angle or rate
    double max_rate = 0.0;  ///< on the way to a position
  };
  void stepJoint(Joint& joint, double low, double high, double backlash, double dt_s) const;

  PanTiltParams params_;
  Joint pan_;
  Joint tilt_;
};

/// The motion of a unicycle over dt with constant speeds: an exact arc.
Pose2 arcMotion(double v_mps, double w_radps, double dt_s);

/// Distance from a point to a convex, counter-clockwise outline; 0 inside.
double distanceToOutline(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& outline);

}  // namespace vismem
