/// @file The common part of E1, E4 and primitives: the robot turns once on the spot, drives one metre and
/// turns again; the memory is scored after both turns. See E1, E4.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/geometry/pose.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_files.h"
#include "experiments/app/experiment_run.h"

namespace vismem {

/// elements.csv and edges.csv: the verdict on every remembered element and every true edge.
class JudgementFiles {
 public:
  explicit JudgementFiles(const std::filesystem::path& folder);
  /// @param after part of the run: "turn", "drive".
  void add(const std::string& variant, const std::string& after, const MemoryScore& score,
           const std::vector<RememberedEdge>& memory, const std::vector<TrueEdge>& edges);
  /// @throws std::runtime_error naming the file that could not be written.
  void close();

 private:
  CsvFile elements_;
  CsvFile edges_;
};

struct LookAroundWay {
  double turn_rate_radps = 0.35;  ///< 20 degrees per second
  double way_m = 1.0;
  double speed_mps = 0.3;
};

/// @param json receives `turn` and `drive` with the figures after each.
/// @return the score at the end.
/// @throws std::runtime_error when the robot is blocked.
MemoryScore lookAroundTwice(ExperimentRun& run, const std::string& variant, const LookAroundWay& way,
                            JudgementFiles& files, nlohmann::json& json);

/// The first of up to 1000 drawn places with a free way ahead, with 0.3 m to either side.
/// @throws std::runtime_error if there is none.
Pose2 placeWithFreeWay(const World& world, double way_m, const std::function<Pose2()>& draw);

/// A place near the middle of a room, with the way of LookAroundWay free ahead. The same seed gives the same
/// place.
Pose2 startNearMiddle(const World& world, std::uint64_t seed);

/// The last image against the memory.
BoardPanel imagePanel(const ExperimentRun& run, std::string title);

/// The memory over the true edges, with the robot and its view; the figures below.
BoardPanel scorePanel(const ExperimentRun& run, const MemoryScore& score, std::string title);

}  // namespace vismem
