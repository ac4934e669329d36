/// @file Races, and the rules by which they are born, merged, replaced, deleted and chosen. Pure. SPEC L1,
/// L7, L8.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "localization/core/params.h"

namespace vismem {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// L1: a place where the robot may be, with its health in 0..1.
struct Individual {
  Pose2 T_world_robot;
  double health = 0.0;
  bool is_rated = false;  ///< chapter mode: `health` is that of the last observation
};

/// A hypothesis. Chapter mode searches around it with individuals; the default mode keeps a covariance
/// and evidence instead. Both are judged by the same table.
struct Race {
  std::uint64_t id = 0;
  Pose2 T_world_robot;
  double health = 0.0;
  int victories = 0;           ///< 0..maximum_victories
  int age = 0;                 ///< iterations since birth; a candidate at the same place adds one more
  int since_best = 1'000'000;  ///< iterations since it was the best; large if it never was
  std::vector<Individual>
      individuals;  ///< chapter mode: after rating the elite first, the best before the others
  /// Default mode: how far the camera leans from where the robot's kinematics put it, about the robot's y
  /// axis (positive looks down) and its x axis (positive drops the right side) [rad]. The lasting part of it;
  /// what changes from image to image is estimated with each image and forgotten.
  Eigen::Vector2d camera_lean = Eigen::Vector2d::Zero();
  Matrix5d P = Matrix5d::Zero();  ///< default mode: covariance of (x, y, theta, lean about y, lean about x)
  /// What is told of the pose's error. Default mode: P is wider than errors where that keeps a race open to
  /// what it sees, and narrower where the memory repeats itself; this is neither. Chapter mode: the elite's.
  Matrix5d P_stated = Matrix5d::Zero();
  double evidence = 0.0;        ///< default mode [nats]
  double log_likelihood = 0.0;  ///< default mode: of the last observation [nats]
  /// Default mode: of the observations kept in PastObservations, newest first; fewer where it is younger.
  std::vector<double> past;
};

/// True if two poses count as one place: x, y and heading (on the circle) each within their limit.
bool samePlace(const Pose2& a, const Pose2& b, const RaceParams& params);

/// The living races. Invariant: at most `maximum`, ids never used twice, the winner is one of them.
/// *Single-threaded* (owner: Localizer).
class RaceTable {
 public:
  explicit RaceTable(const RaceParams& params) : params_(params) {}

  /// What happened to a candidate (L7).
  enum class Admission { kAged, kCreated, kReplaced, kIgnored };

  /// The start of an iteration: all grow one older.
  void age();
  /// Admits a founded race or ages the one at its place. Its id is set here.
  Admission admit(Race candidate);
  /// False if `admit` would only age the race at its place or ignore it, whatever other candidates come
  /// first.
  /// @param most_health of any candidate that comes.
  bool mayAdmit(const Race& candidate, double most_health) const;
  /// Someone knows where the robot is: this race alone, as the winner.
  void replaceAll(Race race);
  /// L7: deletes what has no victories and health under the limit, unless protected.
  /// @param also deletes unprotected races without victories for which the predicate holds.
  template <typename Predicate>
  void removeWeak(Predicate also) {
    std::erase_if(races_, [&](const Race& race) {
      return !isProtected(race) && race.victories == 0 && (race.health < params_.delete_health || also(race));
    });
    forgetMissingWinner();
  }
  void removeWeak() {
    removeWeak([](const Race&) { return false; });
  }
  /// L7: of two at one place the one with fewer victories goes; on a tie the one with lower health.
  void mergeSamePlaces();
  /// The race gains a victory, all others lose one, within 0..maximum_victories.
  void award(std::uint64_t id);
  /// Notes that the race was the best of this iteration (protects it for a while).
  void noteBest(std::uint64_t id);
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
  /// True if a candidate of this health may take its place once it is old enough.
  bool mayGive(const Race& race, double health) const {
    return race.since_best >= params_.protected_after_best && race.victories == 0 && race.health < health;
  }
  bool isFull() const { return static_cast<int>(races_.size()) >= params_.maximum; }

  RaceParams params_;
  std::vector<Race> races_;
  std::uint64_t next_id_ = 1;
  std::uint64_t winner_ = 0;
};

/// L8 as published: the healthiest gains a victory (the others lose one) if it was already chosen or leads
/// by more than `lead`; then the race with most victories is chosen.
void chooseByVictories(RaceTable& table, double lead);

}  // namespace vismem
