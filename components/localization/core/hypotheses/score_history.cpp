#include "localization/core/hypotheses/score_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "localization/core/hypotheses/race.h"

namespace vismem {
namespace {

constexpr double kLeastNovelty = 0.5;  // of an observation that is kept
constexpr int kLong = 1'000'000;       // iterations: the start of the mean no longer matters
constexpr std::size_t kPoints = 40;    // of each observation
/// Odometry errs on the way back into the past, and scores compare places rather than centimetres.
constexpr double kBlur_m = 0.10;

}  // namespace

void ScoreHistory::begin(const FloorObservation& observation, const Pose2& T_odom_robot, double novelty) {
  mean_weight_ = meanWeight();
  if (has_current_) {
    for (Kept& one : kept_) one.weight *= 1.0 - newestWeight();
    current_.weight = newestWeight();
    if (is_repeat_) {
      kept_.front().weight += current_.weight;
    } else {
      // The oldest one's place becomes the newest one's.
      if (kept_.size() < kMostScores) kept_.emplace_back();
      std::rotate(kept_.begin(), std::prev(kept_.end()), kept_.end());
      std::swap(kept_.front(), current_);
    }
  }
  T_odom_robot_ = T_odom_robot;
  ++iteration_;
  novelty_ = novelty;
  newest_observed_ = weightOf(observation);
  is_repeat_ = novelty < kLeastNovelty && !kept_.empty();
  has_current_ = true;
  current_ = {0.0, T_odom_robot, thinned(observation, kPoints, std::move(current_.observation))};
}

void ScoreHistory::record(Race& race) const {
  if (!has_current_ || is_repeat_) return;
  Scores& scores = race.scores;
  if (scores.size() < kMostScores) scores.conservativeResize(scores.size() + 1);
  std::rotate(scores.begin(), std::prev(scores.end()), scores.end());
  const Placement placement = race.placement();
  scores[0] = likelihood_.rate(current_.observation, placement, kBlur_m).log_likelihood;
  ++race.scores_since_jump;
}

void ScoreHistory::clear(bool is_place_known) {
  kept_.clear();
  has_current_ = false;
  countAsNew();
  iteration_ = is_place_known ? kLong : 0;
  mean_weight_ = newest_observed_;
}

double ScoreHistory::newestWeight() const {
  const double forgetting = params_.forgetting;
  return novelty_ * (1.0 - forgetting) / (1.0 - std::pow(forgetting, std::max(1, iteration_)));
}

double ScoreHistory::meanWeight() const {
  return mean_weight_ + newestWeight() * (newest_observed_ - mean_weight_);
}

Scores ScoreHistory::scoresAt(const Pose2& T_world_robot) const {
  Scores scores(static_cast<Eigen::Index>(kept_.size()));
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const Pose2 T_world_then = T_world_robot * (inverse(T_odom_robot_) * kept_[k].T_odom_robot);
    const Rating rating = likelihood_.rate(kept_[k].observation, {T_world_then}, kBlur_m);
    scores[static_cast<Eigen::Index>(k)] = rating.log_likelihood;
  }
  return scores;
}

InitialEvidence ScoreHistory::initialEvidence(const Pose2& T_world_robot, double log_likelihood,
                                              std::span<const Race> races) const {
  const Scores own = scoresAt(T_world_robot);
  Scores weights(own.size());
  double all_weights = 0.0;
  double mean = 0.0;
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    weights[k] = kept_[static_cast<std::size_t>(k)].weight * (1.0 - newestWeight());
    all_weights += weights[k];
    mean += weights[k] * own[k];
  }
  InitialEvidence result{all_weights > 0.0 ? mean / all_weights : log_likelihood, own};
  const Race* heir_of = nullptr;
  for (const Race& race : races) {
    const Eigen::Index known = std::min(race.scores.size(), own.size());
    const bool never_jumped = race.scores_since_jump >= own.size();
    double gain = 0.0;
    double most = 0.0;
    double gain_since_its_jump = 0.0;
    int since_jump = 0;
    for (int k = 0; k < known; ++k) {
      gain += weights[k] * (own[k] - race.scores[k]);
      if (k < race.scores_since_jump) gain_since_its_jump = gain;
      if (gain <= most) continue;
      most = gain;
      since_jump = k + 1;
    }
    double evidence = race.evidence + most - params_.jump_log_prior;
    const bool is_compared =
        never_jumped ? known == own.size() && all_weights > 0.0 : race.scores_since_jump > 0;
    if (is_compared) {
      // Without a jump the kept observations stand for the whole past.
      const double change = gain_since_its_jump / (never_jumped ? all_weights : 1.0);
      const double shared = race.evidence + std::min(0.0, change);
      if (shared > evidence) {
        evidence = shared;
        since_jump = race.scores_since_jump;
      }
    }
    if (heir_of && evidence <= result.evidence) continue;
    result.evidence = evidence;
    result.scores_since_jump = since_jump;
    heir_of = &race;
  }
  if (!heir_of) return result;
  const Eigen::Index known = std::min(result.scores.size(), heir_of->scores.size());
  for (Eigen::Index k = result.scores_since_jump; k < known; ++k) result.scores[k] = heir_of->scores[k];
  return result;
}

}  // namespace vismem
