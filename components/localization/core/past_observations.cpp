#include "localization/core/past_observations.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr std::size_t kMost = 24;    // iterations: nearly five seconds
constexpr int kLong = 1'000'000;     // iterations: nobody remembers when it began
constexpr std::size_t kPoints = 40;  // of each
/// Odometry errs on the way back into the past, and what is asked for is the place, not the last centimetre.
constexpr double kBlur_m = 0.10;

}  // namespace

void PastObservations::begin(const RobustObservation& observation, const Pose2& T_odom_robot) {
  if (current_) {
    for (Kept& one : kept_) one.weight *= 1.0 - newest();
    current_->weight = newest();
    kept_.push_front(std::move(*current_));
    if (kept_.size() > kMost) kept_.pop_back();
    current_.reset();
  }
  T_odom_robot_ = T_odom_robot;
  ++iteration_;
  current_ = Kept{0.0, T_odom_robot, {}};
  weighAgain(observation);
}

void PastObservations::weighAgain(const RobustObservation& observation) {
  news_ = observation.news;
  if (current_) current_->observation = thinned(observation, kPoints);
}

void PastObservations::note(Race& race) const {
  if (!current_) return;
  if (race.past.size() >= kMost) race.past.pop_back();
  const Placement placement{race.T_world_robot, race.camera_lean};
  race.past.insert(race.past.begin(), likelihood_.rate(current_->observation, placement, kBlur_m).news);
}

void PastObservations::clear(bool is_place_known) {
  kept_.clear();
  current_.reset();
  iteration_ = is_place_known ? kLong : 0;
  news_ = 1.0;
}

double PastObservations::newest() const {
  const double forgetting = params_.forgetting;
  return news_ * (1.0 - forgetting) / (1.0 - std::pow(forgetting, std::max(1, iteration_)));
}

std::vector<double> PastObservations::ask(const Pose2& T_world_robot) const {
  std::vector<double> past;
  past.reserve(kMost);
  for (const Kept& one : kept_) {
    const Pose2 T_world_then = T_world_robot * (inverse(T_odom_robot_) * one.T_odom_robot);
    past.push_back(likelihood_.rate(one.observation, {T_world_then}, kBlur_m).news);
  }
  return past;
}

void PastObservations::earn(Race& newcomer, std::span<const Race> races) const {
  const std::vector<double> own = ask(newcomer.T_world_robot);
  std::vector<double> weights;
  double all_weights = 0.0;
  double mean = 0.0;
  for (std::size_t k = 0; k < own.size(); ++k) {
    weights.push_back(kept_[k].weight * (1.0 - newest()));
    all_weights += weights.back();
    mean += weights.back() * own[k];
  }
  newcomer.past = own;
  newcomer.evidence = all_weights > 0.0 ? mean / all_weights : newcomer.log_likelihood;
  const Race* heir_of = nullptr;
  std::size_t since = 0;  // so many of the last observations are the newcomer's own
  for (const Race& race : races) {
    const std::size_t known = std::min(race.past.size(), own.size());
    double gain = 0.0;
    double most = 0.0;
    std::size_t jumped = 0;
    for (std::size_t k = 0; k < known; ++k) {
      gain += weights[k] * (own[k] - race.past[k]);
      if (gain <= most) continue;
      most = gain;
      jumped = k + 1;
    }
    double evidence = race.evidence + most - params_.birth_penalty;
    if (known == own.size() && all_weights > 0.0) {
      const double always = race.evidence + std::min(0.0, gain / all_weights);
      if (always > evidence) {
        evidence = always;
        jumped = known;
      }
    }
    if (heir_of && evidence <= newcomer.evidence) continue;
    newcomer.evidence = evidence;
    heir_of = &race;
    since = jumped;
  }
  if (!heir_of) return;
  for (std::size_t k = since; k < newcomer.past.size(); ++k) {
    if (k < heir_of->past.size()) newcomer.past[k] = heir_of->past[k];
  }
}

}  // namespace vismem
