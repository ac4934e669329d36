/// @file One run of an experiment: the robot in its world and its memory in lock-step, what it does, and the
/// truth of what its images showed. SPEC E1-E4.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "experiments/app/evaluation_setup.h"
#include "experiments/core/floor_truth.h"
#include "experiments/core/lockstep.h"
#include "experiments/core/memory_score.h"

namespace vismem {

struct ExperimentRunOptions {
  std::string world = "room";  ///< cfg/worlds/NAME.world and cfg/maps/NAME.csv
  std::string setup = "sim";   ///< cfg/SETUP
  std::string mode = "default";
  std::uint64_t seed = 1;
  Pose2 start;
  double camera_rate_hz = 10.0;
  std::function<void(SimulationConfig&)> change_robot;       ///< may be empty
  std::function<void(MemoryPipelineParams&)> change_memory;  ///< may be empty
  FloorTruthParams truth;
};

/// *Single-threaded* (owner: the experiment). The same options give the same run.
class ExperimentRun {
 public:
  /// Called after each image.
  using Visitor = std::function<void(const LockstepFrame&)>;

  /// @throws ConfigError, std::invalid_argument with what is wrong with a file or the start.
  explicit ExperimentRun(const ExperimentRunOptions& options);

  void onFrame(Visitor visitor) { visitor_ = std::move(visitor); }

  /// Turns on the spot by an angle of any size (positive: to the left), and stands.
  void turn(double angle_rad, double rate_radps);
  /// Drives straight on, and stands.
  void drive(double distance_m, double speed_mps);
  /// Any driver, until `done`, at most so long. @return whether it was done.
  bool run(const Lockstep::Driver& driver, const std::function<bool()>& done, double at_most_s);
  void stand(double seconds);

  Simulation& simulation() { return *simulation_; }
  MemoryPipeline& pipeline() { return *memory_; }
  const EvaluationParams& params() const { return params_; }
  const FloorTruth& truth() const { return truth_; }
  double now_s() const { return toSeconds(simulation_->now()); }

  const MemorySnapshot& snapshot() const { return *last_.snapshot; }
  const ImageAnalysis& analysis() const { return *last_.analysis; }
  const std::optional<Frame>& lastImage() const { return last_image_; }
  /// The pose that belongs to the snapshot's image.
  Pose2 trueRobot() const { return true_robot_; }
  MemoryScore score() const;

  /// Of the last image: the true pose of its camera, and what it could see of the floor.
  Pose3 truePoseOfImage() const { return simulation_->lastExposure()->T_world_camera; }
  SeesFloor seesFloor() const;

  /// Of the images so far: true edges with a visible part of 10 px or more.
  double meanEdgesPerImage() const { return images_ > 0 ? edges_in_images_ / images_ : 0.0; }
  int mostEdgesInAnImage() const { return most_edges_; }
  int images() const { return images_; }

 private:
  ExperimentRun(const ExperimentRunOptions& options, SimulationConfig robot);
  void frame(const LockstepFrame& frame);

  EvaluationParams params_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<MemoryPipeline> memory_;
  std::unique_ptr<Lockstep> lockstep_;
  FloorTruth truth_;
  Visitor visitor_;
  MemoryUpdate last_;
  std::optional<Frame> last_image_;
  Pose2 true_robot_;
  int images_ = 0;
  double edges_in_images_ = 0.0;
  int most_edges_ = 0;
};

}  // namespace vismem
