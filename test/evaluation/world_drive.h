/// @file A drive through one of the project's worlds in lock-step, with its figures.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/routes/route.h"
#include "common/segment_map/symmetry.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/core/lockstep.h"
#include "evaluation/core/metrics.h"
#include "localization/core/localizer.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

namespace vismem {

struct WorldDrive {
  double driven_m = 0.0;              ///< path of the true poses
  double from_route_m = 0.0;          ///< largest distance of a true pose from the route
  double longest_stand_s = 0.0;       ///< longest time without 5 cm of travel
  int collisions = 0;                 ///< images during a collision
  LocalizationScore score;            ///< modulo the map's symmetries
  std::vector<std::string> problems;  ///< of the scenario
};

/// The names of the worlds in cfg/worlds, sorted.
inline std::vector<std::string> shippedWorlds() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(VISMEM_SOURCE_DIR "/cfg/worlds")) {
    if (entry.path().extension() == ".world") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Drives the route of a world from a start drawn from the seed.
/// @param knows_start whether localization gets the start after the first image.
inline WorldDrive driveWorld(const std::string& world, const std::string& setup, std::uint64_t seed,
                             double seconds, bool knows_start) {
  const EvaluationOptions options = inProjectWorld(world, setup, seed, 10.0);
  const EvaluationParams params = loadParams(options, true);
  std::filesystem::path route_file = options.world;
  route_file.replace_extension(".route");
  Route route = loadRoute(route_file);
  const RouteStart start = startOnRoute(route, seed);
  if (start.backwards) route = reversed(route);
  const auto robot = makeSimulation(options, route, start.T_world_robot);
  MemoryPipeline memory(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, seed);
  Lockstep run(*robot, params.assembler, memory, &localizer);

  WorldDrive drive;
  Trajectory truth;
  std::vector<PublishedPose> published;
  TruthSample moved;
  run.run(
      [&](const LockstepFrame& frame) {
        if (knows_start && published.empty()) localizer.setPose(start.T_world_robot);
        const TruthSample now = robot->truth();
        const Eigen::Vector2d position = now.T_world_robot.position();
        if (truth.empty() || (position - moved.T_world_robot.position()).norm() > 0.05) moved = now;
        drive.longest_stand_s = std::max(drive.longest_stand_s, toSeconds(now.stamp_us - moved.stamp_us));
        drive.from_route_m =
            std::max(drive.from_route_m, (nearestPlace(route, position).position - position).norm());
        drive.collisions += now.in_collision ? 1 : 0;
        append(truth, {now.stamp_us, now.T_world_robot});
        const RobotObservation& seen = frame.observation;
        std::optional<Pose2> pose;
        if (frame.estimate.T_world_robot) {
          pose = *frame.estimate.T_world_robot * inverse(frame.estimate.T_odom_robot) * seen.T_odom_robot;
        }
        published.push_back({seen.frame.stamp_us, pose, frame.estimate.reliability});
      },
      toStampUs(seconds));
  drive.driven_m = pathLength(truth);
  ScoreParams judge;
  judge.symmetries = symmetriesOf(params.map_edges);
  drive.score = scoreLocalization(published, truth, {}, judge);
  drive.problems = robot->takeScenarioProblems();
  return drive;
}

}  // namespace vismem
