/// @file Scores of the last observations, kept to give a new race evidence for the past, too. Pure. See L12.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/config/parameter_visitor.h"
#include "localization/core/likelihood/robust_likelihood.h"

namespace vismem {

struct ScoreHistoryParams {
  double forgetting = 0.95;     ///< factor on evidence per iteration; 0: the last observation alone
  double jump_log_prior = 2.5;  ///< log prior odds against a jump of the robot [nats]

  void visit(ParameterVisitor& v) {
    v.real(expert("Forgetting", "factor on evidence per iteration"), forgetting, 0.0, 0.9999);
    v.alias("BirthPenalty", "JumpLogPrior");
    v.real(expert("JumpLogPrior", "log prior odds against a jump of the robot [nats]"), jump_log_prior, 0.0,
           1e6);
  }
};

inline constexpr int kMostScores = 24;  ///< iterations: nearly five seconds

/// Scores of the kept observations, newest first; fewer for a younger race [nats].
using Scores = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostScores, 1>;

struct Race;

/// Evidence of a race that begins now.
struct InitialEvidence {
  double evidence = 0.0;  ///< [nats]
  Scores scores;
  int scores_since_jump = kMostScores;  ///< as in Race
};

/// The last observations, newest first, each with the odometry pose at its stamp. Each race carries its
/// scores of the same observations, so that a new race is compared with it on equal data. *Single-threaded*
/// (owner: RobustRaces); keeps a reference to the likelihood.
class ScoreHistory {
 public:
  ScoreHistory(const RobustLikelihood& likelihood, const ScoreHistoryParams& params)
      : likelihood_(likelihood), params_(params) {}

  /// Starts an iteration with its observation.
  /// @param novelty of the observation, 0..1; scales its weight (ObservationNovelty).
  void begin(const FloorObservation& observation, const Pose2& T_odom_robot, double novelty);
  /// Gives this iteration's observation its full weight, for a robot that may have been moved.
  void countAsNew() {
    novelty_ = 1.0;
    is_repeat_ = false;
  }
  /// Adds a race's score of this iteration's observation in front. To be called for every race.
  void record(Race& race) const;
  /// Drops all observations, after a jump of odometry or a pose given from outside.
  /// @param is_place_known the races' evidence stands for a long past; else the next observations start it.
  void clear(bool is_place_known);

  /// Weight of this iteration's observation in the running mean that evidence is: equal weights at first,
  /// exponential forgetting later; scaled by novelty.
  double newestWeight() const;
  /// The same running mean of the observations' weights in effective points (weightOf).
  double meanWeight() const;

  /// The largest evidence over two explanations and all races:
  /// - The robot was at the race's pose until some moment and jumped here: the race's evidence minus
  ///   `jump_log_prior` plus the gain in score since then.
  /// - It came here when it would have come to the race's pose, or was here all the time: the race's evidence
  ///   minus the loss in score since then. A gain is not credited: a new race fits the present image by
  ///   selection.
  /// Without any race: the mean score over the kept observations.
  /// @param log_likelihood of the newest observation, for an empty history.
  InitialEvidence initialEvidence(const Pose2& T_world_robot, double log_likelihood,
                                  std::span<const Race> races) const;

 private:
  struct Kept {
    double weight = 0.0;  ///< in the mean that evidence was before this iteration
    Pose2 T_odom_robot;
    FloorObservation observation;
  };
  /// Scores of all kept observations for a robot that is at a pose now.
  Scores scoresAt(const Pose2& T_world_robot) const;

  const RobustLikelihood& likelihood_;
  ScoreHistoryParams params_;
  int iteration_ = 0;
  double novelty_ = 1.0;          ///< of this iteration's observation
  double mean_weight_ = 0.0;      ///< before this iteration
  double newest_observed_ = 0.0;  ///< weight of this iteration's observation
  /// This iteration's observation repeats a kept one and is not kept, so that views of other places stay.
  bool is_repeat_ = false;
  std::vector<Kept> kept_;
  bool has_current_ = false;
  Kept current_;  ///< of this iteration
  Pose2 T_odom_robot_;
};

}  // namespace vismem
