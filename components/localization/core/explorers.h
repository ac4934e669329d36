/// @file Where to look for the robot when no race knows: uniform and constructed explorers. Pure. SPEC L6;
/// DESIGN 9 part 6.
#pragma once

#include <cstdint>
#include <vector>

#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/race.h"
#include "localization/core/random_engine.h"
#include "localization/core/robust_observation.h"

namespace vismem {

/// A place uniform over the map's bounding box (grown by the margin) and all headings.
Pose2 uniformExplorer(const MapIndex& map, double margin_m, RandomEngine& engine);

/// Share of the uniform explorers that are worth sending out in a map of this size where others are
/// constructed: in a larger one than `area_m2` they find the robot the more seldom. 0: 1 in every map.
double uniformShare(const MapIndex& map, double margin_m, double area_m2);

/// Places at which one remembered segment lies on one map segment of its label: the segment by weight, the
/// map segment by length, turned either way, an end on an end half of the time and anywhere along otherwise.
/// *Pure* after construction (sums of lengths, once per map).
class ConstructedExplorers {
 public:
  explicit ConstructedExplorers(const MapIndex& map);

  /// Empty if the observation has no segments.
  std::optional<Pose2> propose(const RobustObservation& observation, RandomEngine& engine) const;

 private:
  struct Line {  // of the map
    double sum;  // of the lengths so far, its own included
    Segment2 plan;
  };
  struct Lines {  // of a label
    std::vector<Line> lines;
    /// Where to begin to look for a share of the whole length: one binary search less over a large map.
    std::vector<std::uint32_t> guide;
    const Line& at(double sum) const;
  };
  std::vector<Lines> by_label_;
};

/// KLD bound: how many samples show a distribution over `places` occupied places with at most this divergence
/// in 99 % of cases. @param places at least 1. @param error > 0 [nats].
int kldBound(int places, double error);

/// L6: how many explorers this iteration sends out. @param iteration counts up by one.
int explorerCount(const ExplorerParams& params, double reliability, std::uint64_t iteration);

/// The health that an explorer needs to be among bestPlaces, as far as the explorers so far tell: others need
/// not be rated in full. It grows while they come.
class CandidateBar {
 public:
  CandidateBar(int count, double list_health, const RaceParams& races);

  /// What is certainly under it is not among bestPlaces, whatever else comes.
  double least() const { return least_; }
  void add(const Individual& explorer);

 private:
  std::size_t count_;
  double least_;
  RaceParams apart_;
  std::vector<Individual> best_;  // so far apart that no place is the same as two of them
};

/// The best `count` of the explorers that lie at different places, best first; healths under `list_health`
/// are left out. Reorders the argument.
std::vector<Individual> bestPlaces(std::vector<Individual>& explorers, int count, double list_health,
                                   const RaceParams& races);

}  // namespace vismem
