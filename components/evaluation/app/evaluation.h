/// @file One evaluation: a recording or a simulated drive through memory and localization in lock-step, with
/// its files and figures of merit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/geometry/pose.h"
#include "evaluation/core/perturbation.h"

namespace vismem {

/// Survey of a recorded floor, CSV files: true edges, edges that do not count, boxes that hide floor.
struct SurveyFiles {
  std::filesystem::path edges;  ///< as a map; empty: no survey
  std::filesystem::path neutral;
  std::filesystem::path obstacles;
};

struct EvaluationOptions {
  std::filesystem::path bag;  ///< exactly one of bag and world is set
  std::filesystem::path world;
  std::filesystem::path map;
  std::filesystem::path out;
  std::filesystem::path palette;  ///< empty: beside the map, else the configuration's
  std::filesystem::path config;   ///< of both components; empty: their files in cfg/SETUP
  std::filesystem::path truth;    ///< of a bag: t_s,x_m,y_m,theta_rad; empty: the bag's own where it has one
  SurveyFiles survey;             ///< of a bag with true poses
  std::string topics;             ///< of a bag: ROLE=/topic,...; empty: found by type
  std::filesystem::path record;   ///< of a world: a folder for a recording; empty: none
  std::filesystem::path second_world;   ///< another world, in which the same commands drive the same robot
  std::filesystem::path second_record;  ///< a folder for what the robot records there
  std::string setup;  ///< cfg/SETUP holds the components and a world's robot; empty: sim, of a bag replay
  std::filesystem::path scenario;  ///< of a world: its events; empty: only the drive along the route
  Perturbation perturbation;       ///< of the camera
  bool profile = false;            ///< real-time factor and CPU time by stage in the summary
  std::filesystem::path route;     ///< of a world: empty: beside it, with the ending .route, if there is one
  std::string mode;        ///< "default" or "chapter", for both components; empty: as each is configured
  bool snapshots = false;  ///< memory.csv and primitives.csv with the memory of each second
  std::uint64_t seed = 1;
  std::optional<Pose2> start;  ///< known start in world; empty: unknown to localization
  std::optional<double> seconds;
  double camera_rate_hz = 10.0;  ///< of a world
  /// Images of a bag, counted from 0, into which the map is projected for map_projection_px.
  std::uint64_t judge_first = 0;
  std::uint64_t judge_last = UINT64_MAX;
};

/// Runs the evaluation and writes all files into options.out, which is checked for writing at the start.
/// @return the summary. A list `problems` in it says why the run is a failure in spite of it: files that
/// could not be written, no label in any image, races that never lived.
/// @throws ConfigError, RecordingError, std::runtime_error naming the wrong input.
nlohmann::json evaluate(const EvaluationOptions& options);

}  // namespace vismem
