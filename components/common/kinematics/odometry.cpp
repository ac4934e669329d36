#include "common/kinematics/odometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/kinematics/kinematics.h"
#include "common/kinematics/random_stream.h"

namespace vismem {
namespace {

constexpr int kSlipSteps = 10;
/// AMCL's standard steps of motion between two updates.
constexpr double kThrunTravel_m = 0.25;
constexpr double kThrunTurn_rad = 0.2;

}  // namespace

OdometryErrorParams noOdometryError() {
  return {};
}
OdometryErrorParams defaultOdometryError() {
  OdometryErrorParams errors;
  errors.radius_sigma = 0.005;
  errors.base_sigma = 0.01;
  errors.travel_sigma_sqrtm = 0.005;
  errors.tick_m = 0.0002;
  return errors;
}
OdometryErrorParams stageOdometryError() {
  OdometryErrorParams errors;
  errors.stage_forward = 0.03;
  errors.stage_turn = 0.05;
  return errors;
}
OdometryErrorParams thrunOdometryError() {
  OdometryErrorParams errors;
  errors.thrun = {0.02, 0.001, 0.001, 0.001};
  return errors;
}

SimulatedOdometry::SimulatedOdometry(const OdometryErrorParams& errors, double wheel_base_m,
                                     std::uint64_t seed)
    : errors_(errors), engine_(seed), slip_engine_(subStream(seed, "slips")) {
  std::normal_distribution<double> normal(0.0, 1.0);
  left_scale_ = 1.0 + errors.radius_sigma * normal(engine_);
  right_scale_ = 1.0 + errors.radius_sigma * normal(engine_);
  wheel_base_m_ = wheel_base_m * (1.0 + errors.base_sigma * normal(engine_));
  std::mt19937_64 stage(subStream(seed, "stage"));
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  forward_scale_ = 1.0 + errors.stage_forward * within(stage);
  turn_scale_ = 1.0 + errors.stage_turn * within(stage);
  since_draw_m_ = std::numeric_limits<double>::infinity();
  if (errors.slips_per_m > 0.0) {
    to_next_slip_m_ = std::exponential_distribution<double>(errors.slips_per_m)(slip_engine_);
  }
}

void SimulatedOdometry::slip(const WheelTravel& extra) {
  slip_per_step_ = {(slip_per_step_.left * slip_steps_ + extra.left) / kSlipSteps,
                    (slip_per_step_.right * slip_steps_ + extra.right) / kSlipSteps};
  slip_steps_ = kSlipSteps;
  ++slips_;
}

WheelTravel SimulatedOdometry::slipOf(const WheelTravel& travel) {
  if (errors_.slips_per_m > 0.0) {
    to_next_slip_m_ -= 0.5 * (std::abs(travel.left) + std::abs(travel.right));
    if (to_next_slip_m_ <= 0.0) {
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      const bool left = uniform(slip_engine_) < 0.5;
      const double size = errors_.slip_m * (0.5 + uniform(slip_engine_));
      const double extra = std::copysign(size, left ? travel.left : travel.right);
      slip(left ? WheelTravel{extra, 0.0} : WheelTravel{0.0, extra});
      to_next_slip_m_ = std::exponential_distribution<double>(errors_.slips_per_m)(slip_engine_);
    }
  }
  if (slip_steps_ == 0) return {};
  --slip_steps_;
  const WheelTravel now = slip_per_step_;
  if (slip_steps_ == 0) slip_per_step_ = {};
  return now;
}

double SimulatedOdometry::quantise(double travel, double& rest) const {
  if (errors_.tick_m <= 0.0) return travel;
  const double total = travel + rest;
  const double whole = std::floor(total / errors_.tick_m) * errors_.tick_m;
  rest = total - whole;
  return whole;
}

void SimulatedOdometry::addAsThrun(double travel_m, double turn_rad) {
  std::normal_distribution<double> normal(0.0, 1.0);
  if (since_draw_m_ >= kThrunTravel_m || since_draw_rad_ >= kThrunTurn_rad) {
    for (double& draw : thrun_draws_) draw = normal(engine_);
    since_draw_m_ = since_draw_rad_ = 0.0;
  }
  since_draw_m_ += std::abs(travel_m);
  since_draw_rad_ += std::abs(turn_rad);
  // On an arc both rotations of the model are half of the whole. All deviations are homogeneous of degree one
  // in the motion, so the steps of a motion sum up to the model's deviation of the whole.
  const double half = 0.5 * turn_rad;
  const auto& a = errors_.thrun;
  const double turn_sigma = std::sqrt(a[0] * half * half + a[1] * travel_m * travel_m);
  const double travel_sigma = std::sqrt(a[2] * travel_m * travel_m + 2.0 * a[3] * half * half);
  pose_ = pose_ * Pose2{0.0, 0.0, thrun_draws_[0] * turn_sigma} *
          arcMotion(travel_m + thrun_draws_[1] * travel_sigma, turn_rad, 1.0) *
          Pose2{0.0, 0.0, thrun_draws_[2] * turn_sigma};
}

void SimulatedOdometry::add(const WheelTravel& travel) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const WheelTravel slip = slipOf(travel);
  const auto noisy = [&](double d, double scale) {
    return d * scale + errors_.travel_sigma_sqrtm * std::sqrt(std::abs(d)) * normal(engine_);
  };
  const double left = quantise(noisy(travel.left + slip.left, left_scale_), left_rest_);
  const double right = quantise(noisy(travel.right + slip.right, right_scale_), right_rest_);
  const double forward = 0.5 * (left + right) * forward_scale_;
  const double turn = (right - left) / wheel_base_m_ * turn_scale_;
  if (std::any_of(errors_.thrun.begin(), errors_.thrun.end(), [](double a) { return a > 0.0; })) {
    addAsThrun(forward, turn);
  } else {
    pose_ = pose_ * arcMotion(forward, turn, 1.0);
  }
}

}  // namespace vismem
