/// @file The set-up of an evaluation: its files, configuration, parameters and robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/kinematics/calibrated_ports.h"
#include "common/robot/observation.h"
#include "common/robot/ports.h"
#include "common/routes/route.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "evaluation/app/evaluation.h"
#include "localization/core/gaze/gaze_planner.h"
#include "localization/core/localizer.h"
#include "simulator/core/simulation.h"

namespace vismem {

/// A run in a world of the project: cfg/worlds/NAME.world with its map, by cfg/SETUP.
EvaluationOptions inProjectWorld(const std::string& world, const std::string& setup, std::uint64_t seed,
                                 double camera_rate_hz);

struct EvaluationParams {
  MemoryPipelineParams pipeline;
  ObservationAssembler::Params assembler;
  JointCorrection joints;
  WheelCorrectionParams wheels;
  LocalizerParams localizer;
  GazePlannerParams gaze;  ///< of localization's gaze requests
  std::filesystem::path palette_file;
  std::shared_ptr<const Palette> palette;
  SegmentMap map;        ///< as in its file
  SegmentMap map_edges;  ///< stripes expanded
};

/// Reads configuration, palette and, where the options name one, the map.
/// @param has_pan_tilt whether images need joint angles.
/// @throws ConfigError with every problem of the wrong file.
EvaluationParams loadParams(const EvaluationOptions& options, bool has_pan_tilt);

/// Puts the components' configurations of a recorded world beside its bags: an evaluation of that folder
/// takes them.
/// @throws ConfigError.
void copyConfiguration(const EvaluationOptions& options);

/// The robot of the setup's simulator.cfg in the options' world, with their seed and camera rate.
/// @throws ConfigError.
SimulationConfig simulationConfig(const EvaluationOptions& options);

/// The robot of the options' setup in their world, playing their scenario. A route is driven by a simulated
/// operator unless the scenario drives itself.
/// @throws ConfigError, std::invalid_argument for a world, start or scenario that cannot be used.
std::unique_ptr<Simulation> makeSimulation(const EvaluationOptions& options,
                                           const std::optional<Route>& route,
                                           const std::optional<Pose2>& start);

}  // namespace vismem
