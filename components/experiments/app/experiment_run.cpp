#include "experiments/app/experiment_run.h"

#include <cmath>
#include <stdexcept>

#include "common/geometry/angles.h"
#include "simulator/core/map_builder.h"
#include "simulator/core/renderer.h"

namespace vismem {
namespace {

constexpr double kVisible_px = 10.0;
/// Tolerance of a ray's length up to a visible floor point.
constexpr double kRayTolerance_m = 0.03;

EvaluationOptions evaluationOptions(const ExperimentRunOptions& options) {
  EvaluationOptions evaluation =
      inProjectWorld(options.world, options.setup, options.seed, options.camera_rate_hz);
  evaluation.mode = options.mode;
  return evaluation;
}

/// The true edges of the world. A map of stripes has both edges of a line in its full length; in the world,
/// joining and crossing lines interrupt them.
SegmentMap trueEdges(const EvaluationParams& params, const World& world) {
  if (params.palette->stripes().empty()) return params.map_edges;
  MapBuilderParams as_they_are;
  as_they_are.join_stripes = false;
  return buildSegmentMap(world, *params.palette, as_they_are);
}

}  // namespace

ExperimentRun::ExperimentRun(const ExperimentRunOptions& options)
    : ExperimentRun(options, simulationConfig(evaluationOptions(options))) {}

ExperimentRun::ExperimentRun(const ExperimentRunOptions& options, SimulationConfig robot)
    : params_(loadParams(evaluationOptions(options), true)),
      truth_(trueEdges(params_, robot.world), options.truth) {
  robot.start = options.start;
  if (options.change_robot) options.change_robot(robot);
  if (options.change_memory) options.change_memory(params_.pipeline);
  simulation_ = std::make_unique<Simulation>(std::move(robot));
  memory_ = std::make_unique<MemoryPipeline>(params_.pipeline, params_.palette);
  lockstep_ = std::make_unique<Lockstep>(*simulation_, params_.assembler, *memory_);
}

void ExperimentRun::frame(const LockstepFrame& frame) {
  const StampUs stamp_us = frame.observation.frame.stamp_us;
  last_ = frame.memory.update;
  last_image_ = frame.observation.frame;
  for (const TruthSample& sample : simulation_->truthSince(stamp_us - Simulation::kStep_us)) {
    if (sample.stamp_us <= stamp_us) true_robot_ = sample.T_world_robot;
  }
  const int edges =
      truth_.addView(frame.observation.frame.intrinsics, truePoseOfImage(), seesFloor(), kVisible_px);
  ++images_;
  edges_in_images_ += edges;
  most_edges_ = std::max(most_edges_, edges);
  if (visitor_) visitor_(frame);
}

SeesFloor ExperimentRun::seesFloor() const {
  return [&world = simulation_->renderer()](const Eigen::Vector3d& camera, const Eigen::Vector3d& floor) {
    const Eigen::Vector3d ray = floor - camera;
    const double range = ray.norm();
    const auto hit = world.cast(camera, ray / range);
    return hit && hit->distance_m >= range - kRayTolerance_m;
  };
}

bool ExperimentRun::run(const Lockstep::Driver& driver, const std::function<bool()>& done, double at_most_s) {
  lockstep_->setDriver(driver);
  const StampUs end = simulation_->now() + toStampUs(at_most_s);
  while (simulation_->now() < end && !done()) {
    lockstep_->step([this](const LockstepFrame& seen) { frame(seen); });
  }
  return done();
}

void ExperimentRun::stand(double seconds) {
  run([](MobileBase& base) { base.setVelocity(0.0, 0.0); }, [] { return false; }, seconds);
}

void ExperimentRun::turn(double angle_rad, double rate_radps) {
  double turned = 0.0;
  double heading = simulation_->truth().T_world_robot.theta;
  const auto done = [&] {
    const double now = simulation_->truth().T_world_robot.theta;
    turned += angleDifference(now, heading);
    heading = now;
    return std::abs(turned) >= std::abs(angle_rad);
  };
  const double w = std::copysign(rate_radps, angle_rad);
  const double seconds = 2.0 + 2.0 * std::abs(angle_rad) / rate_radps;
  if (!run([w](MobileBase& base) { base.setVelocity(0.0, w); }, done, seconds)) {
    throw std::runtime_error("the robot could not turn: something holds it");
  }
  stand(0.3);
}

void ExperimentRun::drive(double distance_m, double speed_mps) {
  const Eigen::Vector2d from = simulation_->truth().T_world_robot.position();
  const auto done = [&] {
    return (simulation_->truth().T_world_robot.position() - from).norm() >= distance_m;
  };
  const double seconds = 2.0 + 2.0 * distance_m / speed_mps;
  if (!run([speed_mps](MobileBase& base) { base.setVelocity(speed_mps, 0.0); }, done, seconds)) {
    throw std::runtime_error("the robot could not drive on: something holds it");
  }
  stand(0.3);
}

MemoryScore ExperimentRun::score() const {
  MemoryScoreParams params;
  if (last_image_) params.focal_px = last_image_->intrinsics.fx;
  return scoreMemory(rememberedIn(snapshot(), true_robot_), truth_.edges(), params);
}

}  // namespace vismem
