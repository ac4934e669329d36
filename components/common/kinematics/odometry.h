/// @file Dead reckoning of a simulated robot and where it goes wrong. Pure. DESIGN 6.
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

/// Where odometry goes wrong. The errors of our own model are of the wheels, not of the pose, so that it is
/// not the model that a filter assumes; the others are there to compare with.
struct OdometryErrorParams {
  double radius_sigma = 0.0;        ///< wheels: relative error of each wheel's radius, drawn once per run
  double base_sigma = 0.0;          ///< wheels: relative error of the wheel base, drawn once per run
  double travel_sigma_sqrtm = 0.0;  ///< wheels: standard deviation of a wheel's noise after one metre [m]
  double tick_m = 0.0;              ///< wheels: travel of a wheel per encoder tick; 0: no quantisation
  /// stage: relative errors of forward travel and of turning, each drawn once per run, uniform in -E/2..E/2,
  /// as Stage 3 and 4 do it; no noise beside them.
  double stage_forward = 0.0;
  double stage_turn = 0.0;
  /// thrun: alpha1..alpha4 of the sampling model of filters (Thrun, Burgard, Fox: Probabilistic Robotics,
  /// 5.4), turn by turn, turn by travel, travel by travel, travel by turn, as factors of variances. See
  /// SimulatedOdometry for how often it samples.
  std::array<double, 4> thrun{};
  /// A wheel that slips turns further than the robot goes. Events per metre of travel, and the wheel's extra
  /// travel in one event (half to one and a half of it, on one wheel).
  double slips_per_m = 0.0;
  double slip_m = 0.03;
};
OdometryErrorParams noOdometryError();
/// Radii within 0.5 %, base within 1 %, 5 mm after a metre, ticks of 0.2 mm (standard deviations).
OdometryErrorParams defaultOdometryError();
/// Stage's own standard values: 3 % of travel, 5 % of turning, as widths.
OdometryErrorParams stageOdometryError();
/// alpha = 0.02, 0.001, 0.001, 0.001: over a metre straight on, 1.3 degrees and 1.6 cm.
OdometryErrorParams thrunOdometryError();

/// Root of the mean squared error of the position that the wheels' errors make after a straight way of
/// `length_m`, to first order in the errors: with s = sqrt(2) radius_sigma / base and n = sqrt(2)
/// travel_sigma / base it is the root of (s L^2 / 2)^2 + n^2 L^3 / 3 across and (radius_sigma L)^2 / 2 +
/// travel_sigma^2 L / 2 along. Slips and ticks are left out.
double expectedStraightError_m(const OdometryErrorParams& errors, double wheel_base_m, double length_m);

/// Adds up wheel travel as encoders report it. *Single-threaded*. The thrun model draws its three normal
/// numbers anew every 0.25 m or 0.2 rad of motion, as filters do that sample at those steps, and spreads them
/// over it.
class SimulatedOdometry {
 public:
  SimulatedOdometry(const OdometryErrorParams& errors, double wheel_base_m, std::uint64_t seed);
  void add(const WheelTravel& travel);
  /// The encoders will count this much beside the true travel, over the next ten steps.
  void slip(const WheelTravel& extra);
  const Pose2& pose() const { return pose_; }
  std::uint32_t slips() const { return slips_; }

 private:
  WheelTravel slipOf(const WheelTravel& travel);
  /// Travel in whole ticks; the rest waits for the next step.
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
