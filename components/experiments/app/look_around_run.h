/// @file What E1, E4 and the experiment on shapes have in common: the robot turns once on itself, goes one
/// metre and turns again; the memory is scored after both. SPEC E1, E4.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/geometry/pose.h"
#include "experiments/app/experiment_files.h"
#include "experiments/app/experiment_run.h"
#include "experiments/core/board.h"

namespace vismem {

/// elements.csv and edges.csv: what became of every remembered element and of every true edge.
class JudgementFiles {
 public:
  explicit JudgementFiles(const std::filesystem::path& folder);
  /// @param after of the run: "turn", "drive".
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

/// @param json gets `turn` and `drive` with the figures after each.
/// @return the score at the end.
/// @throws std::runtime_error when something holds the robot.
MemoryScore lookAroundTwice(ExperimentRun& run, const std::string& variant, const LookAroundWay& way,
                            JudgementFiles& files, nlohmann::json& json);

/// The first of up to 1000 drawn places that has the way ahead free, with 0.3 m to either side.
/// @throws std::runtime_error if none has.
Pose2 placeWithFreeWay(const World& world, double way_m, const std::function<Pose2()>& draw);

/// Near the middle of a room, with the way of LookAroundWay free ahead. The same seed gives the same place.
Pose2 startNearMiddle(const World& world, std::uint64_t seed);

/// The memory over the true edges, with the robot and its view; the figures below.
BoardPanel scorePanel(const ExperimentRun& run, const MemoryScore& score, std::string title);

}  // namespace vismem
