/// @file What an evaluation is made of: files found, configuration read, robot and parameters. DESIGN 7, 11.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/robot/observation.h"
#include "common/robot/ports.h"
#include "common/routes/route.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "experiments/app/evaluation.h"
#include "experiments/core/trajectory.h"
#include "localization/core/params.h"
#include "simulator/core/simulation.h"

namespace vismem {

/// A file of the project named from its root: below the working directory, else below the folder that holds
/// this program's build. @return `relative` itself if it is in neither, for the message of who opens it.
std::filesystem::path projectFile(const std::filesystem::path& relative);

/// A run in a world of the project: cfg/worlds/NAME.world with its map, by cfg/SETUP.
EvaluationOptions inProjectWorld(const std::string& world, const std::string& setup, std::uint64_t seed,
                                 double camera_rate_hz);

struct EvaluationParams {
  MemoryPipelineParams pipeline;
  ObservationAssembler::Params assembler;
  LocalizerParams localizer;
  GazePlannerParams gaze;  ///< how localization asks for gaze, where it does
  std::filesystem::path palette_file;
  std::shared_ptr<const Palette> palette;
  SegmentMap map;        ///< as it stands in its file
  SegmentMap map_edges;  ///< stripes expanded
};

/// Reads configuration, palette and map. @param has_pan_tilt whether joint angles are awaited.
/// @throws ConfigError with every problem of the file that is wrong.
EvaluationParams loadParams(const EvaluationOptions& options, bool has_pan_tilt);

/// Reads `t_s,x_m,y_m,theta_rad`. @throws ConfigError with every problem: FILE:LINE, found, expected.
Trajectory loadTruth(const std::filesystem::path& file);

/// Reads a route. @throws ConfigError as parseRoute, also when the file cannot be read.
Route routeFromFile(const std::filesystem::path& file);

/// What the setup's simulator.cfg says of the robot, in the options' world, with their seed and camera rate.
/// @throws ConfigError.
SimulationConfig simulationConfig(const EvaluationOptions& options);

/// The robot of the options' setup in their world, playing their scenario. A route is driven by a simulated
/// operator unless the scenario drives itself.
/// @throws ConfigError, std::invalid_argument for a world, start or scenario that cannot be used.
std::unique_ptr<Simulation> makeSimulation(const EvaluationOptions& options,
                                           const std::optional<Route>& route,
                                           const std::optional<Pose2>& start);

}  // namespace vismem
