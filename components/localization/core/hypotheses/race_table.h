/// @file The table of races: birth, merging, replacement, deletion and choice. Pure. Implements L7, L8.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "localization/core/hypotheses/race.h"

namespace vismem {

/// The living races. Invariant: at most `maximum`, ids never used twice, the winner is one of them.
/// *Single-threaded* (owner: Localizer).
class RaceTable {
 public:
  explicit RaceTable(const RaceParams& params) : params_(params) {
    races_.reserve(static_cast<std::size_t>(params.maximum));
  }

  /// What happened to a candidate (L7).
  enum class Admission { kAged, kCreated, kReplaced, kIgnored };

  /// Starts an iteration: increments all ages.
  void age();
  /// Admits a new race or ages the one at its place. Sets its id.
  Admission admit(Race candidate);
  /// False if `admit` would only age the race at its place or ignore the candidate, for any order of the
  /// candidates.
  /// @param most_health largest health of all candidates.
  bool mayAdmit(const Race& candidate, double most_health) const;
  /// Replaces all races by this one, as the winner: the pose is known from outside.
  void replaceAll(Race race);
  /// L7: deletes races with no victories, low health and evidence under a limit, unless protected.
  void prune(double spared_evidence = std::numeric_limits<double>::infinity());
  /// L7: of two at one place the one with fewer victories goes; on a tie the one with lower health.
  void mergeSamePlaces();
  /// The race gains a victory, all others lose one, within 0..maximum_victories.
  void award(std::uint64_t id);
  /// Records the race as the best of this iteration, which protects it for `protected_after_best` iterations.
  void recordBest(std::uint64_t id);
  bool isProtected(const Race& race) const;

  void setWinner(std::uint64_t id) { winner_ = id; }
  /// The chosen race; null while none is chosen or it has died.
  const Race* winner() const { return find(winner_); }
  const Race* find(std::uint64_t id) const;
  const Race* healthiest() const;
  /// The race with most victories; ties go to the current winner, then to the healthier.
  const Race* mostVictories() const;

  std::vector<Race>& races() { return races_; }
  const std::vector<Race>& races() const { return races_; }
  void clear();
  const RaceParams& params() const { return params_; }

 private:
  void forgetMissingWinner();
  /// True if a candidate of this health may replace the race once its age allows it.
  bool isReplaceable(const Race& race, double health) const {
    return race.since_best >= params_.protected_after_best && race.victories == 0 && race.health < health;
  }
  bool isFull() const { return static_cast<int>(races_.size()) >= params_.maximum; }

  RaceParams params_;
  std::vector<Race> races_;
  std::uint64_t next_id_ = 1;
  std::uint64_t winner_ = 0;
};

/// L8 as published: the healthiest race gains a victory, and the others lose one, if it was already chosen or
/// leads by more than `lead` in health. The race with most victories is chosen.
void selectByVictories(RaceTable& table, double lead);

}  // namespace vismem
