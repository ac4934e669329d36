/// @file Dead reckoning of a simulated robot and its errors. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "common/geometry/pose.h"

namespace vismem {

/// The travel of both wheels in one step [m].
struct WheelTravel {
  double left = 0.0;
  double right = 0.0;
};

/// Parameters of odometry errors. The default model has errors of the wheels, not of the pose, so that it
/// differs from the motion model of a filter. The models of Stage and Thrun serve for comparison.
struct OdometryErrorParams {
  double radius_sigma = 0.0;        ///< wheels: relative error of each wheel's radius, drawn once per run
  double base_sigma = 0.0;          ///< wheels: relative error of the wheel base, drawn once per run
  double travel_sigma_sqrtm = 0.0;  ///< wheels: standard deviation of a wheel's noise after one metre [m]
  double tick_m = 0.0;              ///< wheels: travel of a wheel per encoder tick; 0: no quantisation
  /// stage: relative errors of forward travel and of turning, each drawn once per run, uniform in -E/2..E/2,
  /// as in Stage 3 and 4; without noise.
  double stage_forward = 0.0;
  double stage_turn = 0.0;
  /// thrun: alpha1..alpha4 of the sampling motion model (Thrun, Burgard, Fox: Probabilistic Robotics, 5.4):
  /// variance factors turn by turn, turn by travel, travel by travel, travel by turn. SimulatedOdometry
  /// defines the sampling steps.
  std::array<double, 4> thrun{};
  /// Wheel slips: events per metre of travel, and extra travel of one wheel in one event (0.5 to 1.5 times
  /// slip_m) [m].
  double slips_per_m = 0.0;
  double slip_m = 0.03;
};
OdometryErrorParams noOdometryError();
/// Standard deviations: radii 0.5 %, wheel base 1 %, travel 5 mm after 1 m; ticks of 0.2 mm.
OdometryErrorParams defaultOdometryError();
/// Default values of Stage: widths of 3 % of travel and 5 % of turning.
OdometryErrorParams stageOdometryError();
/// alpha = 0.02, 0.001, 0.001, 0.001: standard deviations of 1.3 degrees and 1.6 cm after 1 m straight on.
OdometryErrorParams thrunOdometryError();

/// Dead reckoning from the wheel travel that the encoders report. *Single-threaded*. The thrun model draws
/// its three normal numbers anew every 0.25 m or 0.2 rad of motion and distributes them over that motion.
class SimulatedOdometry {
 public:
  SimulatedOdometry(const OdometryErrorParams& errors, double wheel_base_m, std::uint64_t seed);
  void add(const WheelTravel& travel);
  /// Adds this travel to the encoders over the next ten steps, beside the true travel.
  void slip(const WheelTravel& extra);
  const Pose2& pose() const { return pose_; }
  std::uint32_t slips() const { return slips_; }

 private:
  WheelTravel slipOf(const WheelTravel& travel);
  /// Travel in whole ticks; the rest is added to the next step.
  double quantise(double travel, double& rest) const;
  void addAsThrun(double travel_m, double turn_rad);

  OdometryErrorParams errors_;
  double left_scale_;
  double right_scale_;
  double wheel_base_m_;
  double forward_scale_ = 1.0;
  double turn_scale_ = 1.0;
  double left_rest_ = 0.0;
  double right_rest_ = 0.0;
  double to_next_slip_m_ = 0.0;
  WheelTravel slip_per_step_;
  int slip_steps_ = 0;
  std::uint32_t slips_ = 0;
  std::array<double, 3> thrun_draws_{};
  double since_draw_m_ = 0.0;
  double since_draw_rad_ = 0.0;
  Pose2 pose_;
  std::mt19937_64 engine_;
  std::mt19937_64 slip_engine_;
};

}  // namespace vismem
