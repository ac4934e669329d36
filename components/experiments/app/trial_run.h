/// @file Runs with kidnappings in a simulated world: closed loop of robot, rendered images, memory and
/// gaze. See E5, E6, B4.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "evaluation/app/evaluation_setup.h"
#include "experiments/trials/clutter.h"
#include "experiments/trials/trial.h"

namespace vismem {

/// The gaze policy.
enum class TrialGaze {
  kSalience,      ///< salience alone
  kLocalization,  ///< the robot's localization (default mode, the trial's seed) requests gaze while
                  ///< ambiguous, by the setup's Localization.Gaze keys
  kOracle,        ///< the same with the true place known: a bound for the benefit of requests
};

struct TrialOptions {
  std::string world = "corridor";  ///< cfg/worlds/NAME.world, NAME.route and cfg/maps/NAME.csv
  std::string setup = "sim";       ///< cfg/SETUP
  std::uint64_t seed = 1;
  int events = 5;         ///< the start and kidnappings
  double event_s = 60.0;  ///< from one to the next
  Disturbance disturbance;
  double blackout_from_s = 0.0;  ///< begin of the blackout within each event
  double blackout_s = 0.0;       ///< its length: no segments are observed
  double camera_rate_hz = 10.0;
  TrialGaze gaze = TrialGaze::kSalience;
  std::function<void(SimulationConfig&)> change_robot;  ///< may be empty
};

/// One run. *Single-threaded*. The same options give the same run.
class TrialRun {
 public:
  using Step = AttentiveVisualMemory::StepResult;
  /// Called after each image, with the gaze's request queue.
  using Visitor = std::function<void(const Step&, GazeClient&)>;

  /// @throws ConfigError, std::invalid_argument naming a wrong file.
  explicit TrialRun(const TrialOptions& options);
  ~TrialRun();

  const EvaluationParams& params() const;
  Simulation& simulation();

  /// Runs from the start to the end.
  Trial record(const Visitor& visit = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
