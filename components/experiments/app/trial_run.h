/// @file Runs with kidnappings in a simulated world: closed loop of robot, memory and gaze, with images that
/// are rendered or with segments that are made up from the map. SPEC E5, E6, B4.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "experiments/app/evaluation_setup.h"
#include "experiments/trials/synthetic_vision.h"
#include "experiments/trials/trial.h"
#include "experiments/trials/vision_statistics.h"

namespace vismem {

/// Who decides where the camera looks.
enum class TrialGaze {
  kSalience,      ///< salience alone
  kLocalization,  ///< the robot's own localization (the default mode, with the trial's seed) asks while in
                  ///< doubt, as the setup's Localization.Gaze keys say
  kOracle,        ///< the same, but told the true place: a bound for what asking can bring
};

struct TrialOptions {
  std::string world = "corridor";  ///< cfg/worlds/NAME.world, NAME.route and cfg/maps/NAME.csv
  std::string setup = "sim";       ///< cfg/SETUP
  std::uint64_t seed = 1;
  int events = 5;         ///< the start and kidnappings
  double event_s = 60.0;  ///< from one to the next
  bool rendered = false;  ///< images of the renderer and the whole vision; else segments made up
  VisionErrors errors;    ///< of those
  std::optional<std::uint64_t> map_seed;  ///< of what errs in every image alike; empty: a map for each seed
  Disturbance disturbance;
  double blackout_from_s = 0.0;  ///< in each event: nothing is seen from then on ..
  double blackout_s = 0.0;       ///< .. for so long
  double camera_rate_hz = 10.0;
  TrialGaze gaze = TrialGaze::kSalience;
  std::function<void(SimulationConfig&)> change_robot;  ///< may be empty
};

/// One run. *Single-threaded*. The same options give the same run.
class TrialRun {
 public:
  using Step = AttentiveVisualMemory::StepResult;
  /// Called after each image, with the gaze's mailbox: whoever wants to steer the camera.
  using Visitor = std::function<void(const Step&, GazeClient&)>;

  /// @throws ConfigError, std::invalid_argument with what is wrong with a file.
  explicit TrialRun(const TrialOptions& options);
  ~TrialRun();

  const EvaluationParams& params() const;
  Simulation& simulation();
  /// Counts the vision's errors too, whoever makes the segments. @param statistics must outlive the run.
  void measureVision(VisionStatistics* statistics);

  /// From the start to the end.
  Trial record(const Visitor& visit = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

nlohmann::json toJson(const VisionStatistics& statistics);

}  // namespace vismem
