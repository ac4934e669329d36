/// @file A simulated operator who drives the robot along a route. Pure.
///
/// It simulates a person with a joystick who sees the robot from outside. It uses the true pose, which no
/// estimator reads, and exists for simulations only.
#pragma once

#include "common/routes/route.h"

namespace vismem {

struct DriveCommand {
  double v_mps = 0.0;    ///< forward, never negative
  double w_radps = 0.0;  ///< counter-clockwise
};

struct RouteFollowerParams {
  double speed_mps = 0.3;  ///< on straight lines
  double max_turn_rate_radps = 0.8;
  /// Look-ahead distance of pure pursuit [m]: a smaller one follows closer, a larger one is smoother.
  double look_ahead_m = 0.45;
  /// Turns on the spot above this angle to the look-ahead point [rad].
  double turn_on_spot_beyond_rad = 0.9;
};

/// Pure pursuit with reduced speed in corners. *Single-threaded*.
class SimulatedOperator {
 public:
  /// Starts at the route's nearest place to the first pose. Repeats a closed route, and drives an open one
  /// back and forth.
  /// @throws std::invalid_argument for a parameter that is not positive.
  SimulatedOperator(Route route, const RouteFollowerParams& params);

  /// @param T_world_robot the true pose now.
  DriveCommand drive(const Pose2& T_world_robot);
  /// To be called after a kidnapping: continues at the nearest place of the route.
  void lost() { on_route_ = false; }

 private:
  void advance(const Eigen::Vector2d& position);

  Route route_;
  RouteFollowerParams params_;
  bool on_route_ = false;
  bool forth_ = true;
  double along_m_ = 0.0;
};

}  // namespace vismem
