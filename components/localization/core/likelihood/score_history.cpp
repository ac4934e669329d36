#include "localization/core/likelihood/score_history.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr std::size_t kMost = 24;      // iterations: nearly five seconds
constexpr double kLeastNovelty = 0.5;  // of an observation that is kept
constexpr int kLong = 1'000'000;       // iterations: the start of the mean no longer matters
constexpr std::size_t kPoints = 40;    // of each observation
/// Odometry errs on the way back into the past, and scores compare places rather than centimetres.
constexpr double kBlur_m = 0.10;

}  // namespace

void ScoreHistory::begin(const FloorObservation& observation, const Pose2& T_odom_robot, double novelty) {
  mean_weight_ = meanWeight();
  if (current_) {
    for (Kept& one : kept_) one.weight *= 1.0 - newestWeight();
    current_->weight = newestWeight();
    if (is_repeat_) {
      kept_.front().weight += current_->weight;
    } else {
      kept_.push_front(std::move(*current_));
      if (kept_.size() > kMost) kept_.pop_back();
    }
    current_.reset();
  }
  T_odom_robot_ = T_odom_robot;
  ++iteration_;
  novelty_ = novelty;
  newest_observed_ = weightOf(observation);
  is_repeat_ = novelty < kLeastNovelty && !kept_.empty();
  current_ = Kept{0.0, T_odom_robot, thinned(observation, kPoints)};
}

void ScoreHistory::record(const Placement& placement, std::vector<double>& scores) const {
  if (!current_ || is_repeat_) return;
  if (scores.size() >= kMost) scores.pop_back();
  scores.insert(scores.begin(), likelihood_.rate(current_->observation, placement, kBlur_m).log_likelihood);
}

void ScoreHistory::clear(bool is_place_known) {
  kept_.clear();
  current_.reset();
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

std::vector<double> ScoreHistory::scoresAt(const Pose2& T_world_robot) const {
  std::vector<double> scores;
  scores.reserve(kMost);
  for (const Kept& one : kept_) {
    const Pose2 T_world_then = T_world_robot * (inverse(T_odom_robot_) * one.T_odom_robot);
    scores.push_back(likelihood_.rate(one.observation, {T_world_then}, kBlur_m).log_likelihood);
  }
  return scores;
}

InitialEvidence ScoreHistory::initialEvidence(const Pose2& T_world_robot, double log_likelihood,
                                              std::span<const ScoredRace> races) const {
  const std::vector<double> own = scoresAt(T_world_robot);
  std::vector<double> weights;
  double all_weights = 0.0;
  double mean = 0.0;
  for (std::size_t k = 0; k < own.size(); ++k) {
    weights.push_back(kept_[k].weight * (1.0 - newestWeight()));
    all_weights += weights.back();
    mean += weights.back() * own[k];
  }
  InitialEvidence result{all_weights > 0.0 ? mean / all_weights : log_likelihood, own};
  const ScoredRace* heir_of = nullptr;
  std::size_t since = 0;  // number of newest observations with the new race's own scores
  for (const ScoredRace& race : races) {
    const std::size_t known = std::min(race.scores.size(), own.size());
    double gain = 0.0;
    double most = 0.0;
    std::size_t jumped = 0;
    for (std::size_t k = 0; k < known; ++k) {
      gain += weights[k] * (own[k] - race.scores[k]);
      if (gain <= most) continue;
      most = gain;
      jumped = k + 1;
    }
    double evidence = race.evidence + most - params_.jump_log_prior;
    if (known == own.size() && all_weights > 0.0) {
      const double always = race.evidence + std::min(0.0, gain / all_weights);
      if (always > evidence) {
        evidence = always;
        jumped = known;
      }
    }
    if (heir_of && evidence <= result.evidence) continue;
    result.evidence = evidence;
    heir_of = &race;
    since = jumped;
  }
  if (!heir_of) return result;
  for (std::size_t k = since; k < result.scores.size(); ++k) {
    if (k < heir_of->scores.size()) result.scores[k] = heir_of->scores[k];
  }
  return result;
}

}  // namespace vismem
