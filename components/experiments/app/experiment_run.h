/// @file One run of an experiment: a simulated robot and its memory in lock-step, its motions, and the true
/// edges that its images showed. See E1, E2, E3, E4.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "evaluation/app/evaluation_setup.h"
#include "evaluation/core/floor_truth.h"
#include "evaluation/core/lockstep.h"
#include "evaluation/core/memory_score.h"

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

  /// @throws ConfigError, std::invalid_argument naming a wrong file or start.
  explicit ExperimentRun(const ExperimentRunOptions& options);

  void onFrame(Visitor visitor) { visitor_ = std::move(visitor); }

  /// Turns on the spot by an angle of any size (positive: to the left), then stands.
  void turn(double angle_rad, double rate_radps);
  /// Drives straight ahead, then stands.
  void drive(double distance_m, double speed_mps);
  /// Runs a driver until `done`, at most this long.
  /// @return whether it was done.
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

  /// True camera pose of the last image, and its visibility of floor points.
  Pose3 truePoseOfImage() const { return simulation_->lastExposure()->T_world_camera; }
  SeesFloor seesFloor() const;

  /// Number of true edges with a visible part of 10 px or more in the images so far.
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
