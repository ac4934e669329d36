/// @file What the two modes do differently inside the one loop of races. Pure. SPEC L2; DESIGN 9.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/params.h"
#include "localization/core/race.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// How places are rated, searched, improved, compared and trusted. *Single-threaded* (owner: Localizer).
/// Invariant: every race it returns or leaves in the table is rated by the last observation.
class RaceStrategy {
 public:
  virtual ~RaceStrategy() = default;

  /// Takes the observation of an update. @return false: nothing to judge by, the races stay as they are.
  virtual bool observe(const MemoryUpdate& update) = 0;
  /// The motion operator: the robot moved by T_before_now in its own frame.
  virtual void move(Race& race, const Pose2& T_before_now) const = 0;
  virtual void rate(Race& race) const = 0;
  /// L6: sends explorers out and founds races at the best places, best first.
  virtual std::vector<Race> search(int explorers, const RaceTable& table, RandomEngine& engine) const = 0;
  /// A rated race at a given place.
  virtual Race foundAt(const Pose2& T_world_robot, RandomEngine& engine) const = 0;
  /// Beyond L7's rule: a race that lost too much against the best.
  virtual bool isHopeless(const Race& race, const RaceTable& table) const = 0;
  /// L9 or refinement; the race is rated afterwards.
  virtual void evolve(Race& race, RandomEngine& engine) const = 0;
  /// L8: victories and the winner. @param reliability 0..1 of the last iteration.
  virtual void choose(RaceTable& table, double reliability) const = 0;
  /// Share of belief per race, in the table's order; sums to 1.
  virtual std::vector<double> weights(const RaceTable& table) const = 0;
  /// How far this observation alone lets the winner be believed, 0..1; empty where it says too little. All
  /// races are rated.
  virtual std::optional<double> agreement(const RaceTable& table) const = 0;
  /// True if nothing speaks for another place than the winner's, however little the winner explains.
  virtual bool isUndisputed(const RaceTable& table) const = 0;
  /// The reliability after this iteration, before any jump of the winner is accounted for.
  /// @param elapsed_s since the last one.
  virtual double nextReliability(double last, const RaceTable& table, double elapsed_s) const = 0;
  /// Perhaps the robot was put elsewhere before this observation: what was seen before is no reason to count
  /// it less. The races are to be rated again.
  virtual void takeAsNew() {}
  /// The memory was set aside or the source jumped: what the races earned so far counts no more.
  virtual void forgetEvidence(RaceTable& table) = 0;
  /// Somebody said that the robot is at the table's only race, or (an empty table) that nobody knows where.
  virtual void forgetPast(const RaceTable& table) = 0;
};

std::unique_ptr<RaceStrategy> makeChapterStrategy(const SegmentMap& map_edges, const LocalizerParams& params);
std::unique_ptr<RaceStrategy> makeRobustStrategy(const SegmentMap& map_edges, const LocalizerParams& params);

}  // namespace vismem
