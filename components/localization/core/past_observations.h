/// @file What was seen lately, kept so that a place that is thought of only now can be asked whether it
/// explains that too. Pure. DESIGN 9 part 4.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "localization/core/robust_likelihood.h"

namespace vismem {

/// The last observations, newest first, each where the robot stood by odometry. Every race carries what it
/// made of the same observations (Race::past), so that a newcomer is compared with it like for like.
/// *Single-threaded* (owner: the strategy); keeps references to its arguments.
class PastObservations {
 public:
  PastObservations(const RobustLikelihood& likelihood, const RobustParams& params)
      : likelihood_(likelihood), params_(params) {}

  /// An iteration begins with this observation.
  void begin(const RobustObservation& observation, const Pose2& T_odom_robot);
  /// The news of this iteration's observation is another.
  void weighAgain(const RobustObservation& observation);
  /// What a race makes of this iteration's observation. Every race, every iteration.
  void note(Race& race) const;
  /// Odometry jumped or somebody said something about the place: what was seen says nothing about now.
  /// @param is_place_known the races' evidence stands for a long past; else the first observations make it.
  void clear(bool is_place_known);

  /// Weight of this iteration's observation in the mean that evidence is: of the first ones all count alike,
  /// and what was told before less.
  double newest() const;

  /// Gives a newcomer the evidence of the best of two stories, over all races:
  /// - the robot was where the race says until some moment, and jumped here: the race's evidence, less
  ///   `birth_penalty`, plus how much better the newcomer explains what was seen since then;
  /// - it was here all the time: the race's evidence, less how much worse it explains all that is kept. It is
  ///   never more: a newcomer fits this moment by selection, and leads only by what it shows from now on.
  /// Without any race: the mean over what is kept. @param newcomer rated; its `past` is set too.
  void earn(Race& newcomer, std::span<const Race> races) const;

 private:
  struct Kept {
    double weight = 0.0;  ///< in the mean that evidence was before this iteration
    Pose2 T_odom_robot;
    RobustObservation observation;
  };
  /// What a robot that stands at a place now would have made of all that is kept, newest first.
  std::vector<double> ask(const Pose2& T_world_robot) const;

  const RobustLikelihood& likelihood_;
  const RobustParams& params_;
  int iteration_ = 0;
  double news_ = 1.0;  ///< of this iteration's observation
  std::deque<Kept> kept_;
  std::optional<Kept> current_;  ///< of this iteration
  Pose2 T_odom_robot_;
};

}  // namespace vismem
