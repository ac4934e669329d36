/// @file Explorers: candidate poses outside any race, uniform or constructed from the observation. Pure.
/// Implements L6.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "localization/core/hypotheses/race.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/random_engine.h"

namespace vismem {

struct ExplorerParams {
  int count_lost = 1000;        ///< explorers per search while the pose is unreliable
  int count_reliable = 200;     ///< explorers per search while it is reliable
  int period_reliable = 4;      ///< iterations between searches while it is reliable; else 1
  double reliable_above = 0.6;  ///< smallest reliability of a reliable pose
  int candidates = 6;           ///< M
  double list_health = 0.3;     ///< smallest health of a candidate
  double margin_m = 0.0;        ///< extension of the search beyond the map's bounding box
};

/// A pose uniform over the map's bounding box, extended by the margin, and over all headings.
Pose2 uniformExplorer(const MapIndex& map, double margin_m, RandomEngine& engine);

/// Share of the uniform explorers to send out where others are constructed: area_m2 / map area, at most 1.
/// @param area_m2 0: the share is 1 in every map.
double uniformShare(const MapIndex& map, double margin_m, double area_m2);

/// Poses at which one observed segment lies on one map segment of its label. The observed segment is drawn by
/// weight, the map segment by length, the orientation uniformly; half of the draws align ends, the others a
/// random point along both. *Pure* after construction.
class ConstructedExplorers {
 public:
  explicit ConstructedExplorers(const MapIndex& map);

  /// Empty if the observation has no segments.
  std::optional<Pose2> propose(const FloorObservation& observation, RandomEngine& engine) const;

 private:
  struct Line {  // of the map
    double sum;  // cumulative length, its own included
    Segment2 plan;
  };
  std::vector<std::vector<Line>> by_label_;
};

/// Number of explorers of this iteration.
/// @param is_idle one race has had nearly all belief: the search pauses as for a reliable pose.
/// @param iteration increases by one per iteration.
int explorerCount(const ExplorerParams& params, double reliability, bool is_idle, std::uint64_t iteration);

/// Keeps the best `count` explorers at different places, best first, with a health of at least `list_health`.
void keepBestPlaces(std::vector<Individual>& explorers, int count, double list_health,
                    const RaceParams& races);

}  // namespace vismem
