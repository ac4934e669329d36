/// @file A race: one hypothesis of the robot's pose. Pure. Implements L1. See L7, L9, B2.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "common/geometry/pose.h"
#include "localization/core/hypotheses/score_history.h"
#include "localization/core/likelihood/individual.h"
#include "localization/core/likelihood/placement.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// L7, L8: the table of races. Shared by both modes; the thresholds differ.
struct RaceParams {
  int maximum = 10;
  double same_place_m = 0.20;  ///< in x and in y each
  double same_place_rad = degToRad(30.0);
  double create_health = 0.6;    ///< smallest health of a candidate that becomes a race
  double delete_health = 0.6;    ///< a race with no victories below this is deleted
  int protected_age = 3;         ///< iterations after birth without deletion or replacement
  int protected_after_best = 9;  ///< iterations after having been the best without them
  int maximum_victories = 20;
  /// Default mode: a race keeps its place in a full table if its evidence exceeds the candidate's by more
  /// than this [nats].
  double protected_log_odds = 0.5;

  void visit(ParameterVisitor& v) {
    v.integer(expert("Maximum", "L7: largest number of races"), maximum, 1, 64);
  }
};

/// A hypothesis. Chapter mode searches around it with individuals; the default mode keeps a covariance and
/// evidence instead. Both modes use the same table.
struct Race {
  std::uint64_t id = 0;
  Pose2 T_world_robot;
  double health = 0.0;
  int victories = 0;           ///< 0..maximum_victories
  int age = 0;                 ///< iterations since birth; a candidate at the same place adds one more
  int since_best = 1'000'000;  ///< iterations since it was the best; large if it never was
  /// Chapter mode; after rating the elite first, best first.
  std::vector<Individual> individuals;
  /// Default mode: lasting camera tilt error (Placement::tilt_bias) [rad].
  Eigen::Vector2d camera_tilt = Eigen::Vector2d::Zero();
  /// Default mode: covariance of (x, y, theta, camera tilt) in the filter. Wider than the error where that
  /// keeps a race open to observations, narrower where the memory repeats itself.
  Matrix5d P = Matrix5d::Zero();
  /// Default mode: lasting errors of odometry, states of the filter beside P, and their covariance with
  /// (x, y, theta, camera tilt).
  OdometryBias odometry;
  Eigen::Matrix<double, 5, 3> P_odometry = Eigen::Matrix<double, 5, 3>::Zero();
  /// Covariance that is published. Default mode: from a second filter without these two effects. Chapter
  /// mode: of the elite.
  Matrix5d P_reported = Matrix5d::Zero();
  /// Default mode: mean of Rating::variance_factor over the last seconds.
  double variance_factor = 1.0;
  double evidence = 0.0;        ///< default mode [nats]
  double log_likelihood = 0.0;  ///< default mode: of the last observation [nats]
  /// Default mode: scores of the observations in ScoreHistory.
  Scores scores;
  /// Default mode: number of the newest scores since the robot jumped to this race; kMostScores or more: it
  /// was here all the time.
  int scores_since_jump = kMostScores;

  Placement placement() const { return {T_world_robot, camera_tilt}; }
};

/// True if two poses count as one place: x, y and heading (on the circle) each within their limit.
bool samePlace(const Pose2& a, const Pose2& b, const RaceParams& params);

}  // namespace vismem
