#include "localization/core/gaze_planner.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The health that a race at the right place has, when nothing is wrong.
constexpr double kGoodHealth = 0.7;
/// Doubt below which a look counts as reassuring, as a share of the doubt that makes wishes.
constexpr double kRelief = 0.7;
constexpr std::size_t kMostVisits = 32;

double angleBetweenDirections(const PanTilt& a, const PanTilt& b) {
  const double c = std::sin(a.tilt_rad) * std::sin(b.tilt_rad) +
                   std::cos(a.tilt_rad) * std::cos(b.tilt_rad) * std::cos(a.pan_rad - b.pan_rad);
  return std::acos(std::clamp(c, -1.0, 1.0));
}

/// From the camera to a place, as pan and tilt of an axis on the robot.
PanTilt directionTo(const Eigen::Vector3d& p_odom, const MemoryUpdate& update) {
  const Eigen::Vector3d ray = transform(inverse(update.analysis->T_odom_robot), p_odom) -
                              update.analysis->T_robot_camera.translation();
  return {std::atan2(ray.y(), ray.x()), std::atan2(ray.z(), ray.head<2>().norm())};
}

}  // namespace

int carryOut(const GazePlan& plan, GazeClient& client) {
  int rejected = 0;
  for (const std::string& key : plan.withdrawn) {
    if (!client.withdraw(kGazeClientName, key).ok()) ++rejected;
  }
  for (const GazeRequest& request : plan.requests) {
    if (!client.request(request).ok()) ++rejected;
  }
  return rejected;
}

GazePlanner::GazePlanner(const GazePlannerParams& params, const LocalizerParams& localizer,
                         const SegmentMap& map_edges)
    : params_(params), advisor_(params.advisor, localizer, map_edges) {}

double GazePlanner::doubt(const PoseEstimate& estimate) {
  double trust = 0.0;
  for (const RaceReport& race : estimate.races) {
    // Reliability is slow by design; what the winner explains right now says at once that something happened.
    if (race.winner) {
      trust = race.weight * std::min(estimate.reliability, race.health / kGoodHealth);
    }
  }
  return 1.0 - std::clamp(trust, 0.0, 1.0);
}

std::optional<GazeAdvice> GazePlanner::wish() const {
  return wish_ ? std::optional<GazeAdvice>(wish_->advice) : std::nullopt;
}

bool GazePlanner::isServed(const MemoryUpdate& update) {
  const StampUs now = update.analysis->stamp_us;
  const PanTilt axis = axisOf(update.analysis->T_robot_camera);
  if (angleBetweenDirections(axis, directionTo(wish_->advice.p_odom, update)) <= params_.seen_rad &&
      now != wish_->last_seen_us) {
    if (wish_->images++ == 0) wish_->arrived_us = now;
    wish_->last_seen_us = now;
  }
  return (wish_->images >= params_.images && toSeconds(now - wish_->arrived_us) >= params_.look_s) ||
         toSeconds(now - wish_->since_us) >= params_.deadline_s;
}

void GazePlanner::noteVisit(const MemoryUpdate& update) {
  const PanTilt direction = directionTo(wish_->advice.p_odom, update);
  if (visits_.size() >= kMostVisits) visits_.erase(visits_.begin());
  visits_.push_back({direction.pan_rad + update.analysis->T_odom_robot.theta, direction.tilt_rad,
                     update.analysis->stamp_us});
}

const GazeAdvice* GazePlanner::choose(const std::vector<GazeAdvice>& advice,
                                      const MemoryUpdate& update) const {
  const double heading = update.analysis->T_odom_robot.theta;
  const StampUs now = update.analysis->stamp_us;
  const GazeAdvice* best = nullptr;
  double best_score = 0.0;
  for (const GazeAdvice& one : advice) {
    // What was just looked at for nothing is not looked at again at once, whatever it promises.
    double inhibition = 0.0;
    for (const Visit& visit : visits_) {
      const PanTilt before{visit.bearing_odom - heading, visit.tilt};
      if (angleBetweenDirections(one.direction, before) > params_.inhibition_rad) continue;
      inhibition = std::max(inhibition, std::exp(-toSeconds(now - visit.stamp_us) / params_.inhibition_s));
    }
    const double score = one.score * (1.0 - inhibition);
    if (!best || score > best_score) {
      best = &one;
      best_score = score;
    }
  }
  return best;
}

GazePlan GazePlanner::plan(const PoseEstimate& estimate, const MemoryUpdate& update) {
  GazePlan plan;
  const StampUs now = update.analysis->stamp_us;
  // A new epoch clears the places of gaze; a source that began anew has other stamps.
  if (update.snapshot->epoch != epoch_ || now < last_stamp_us_) {
    if (wish_ && now >= last_stamp_us_) plan.withdrawn.push_back(wish_->key);
    wish_.reset();
    visits_.clear();
    epoch_ = update.snapshot->epoch;
  }
  last_stamp_us_ = now;
  advisor_.look(update);
  const double doubt = GazePlanner::doubt(estimate);
  if (doubt >= params_.doubt_above) {
    if (looks_left_ == 0) {
      // What was seen before doubt began tells nothing any more.
      advisor_.forget();
      advisor_.look(update);
    }
    looks_left_ = params_.confirming_looks;
  }
  if (wish_ && isServed(update)) {
    if (doubt < kRelief * params_.doubt_above) looks_left_ = std::max(0, looks_left_ - 1);
    noteVisit(update);
    plan.withdrawn.push_back(wish_->key);
    wish_.reset();
  }
  if (wish_ || looks_left_ == 0) return plan;
  const std::vector<GazeAdvice> advice = advisor_.advise(estimate, update);
  const GazeAdvice* chosen = choose(advice, update);
  if (chosen == nullptr) return plan;
  wish_ = Wish{"look " + std::to_string(++asked_), *chosen, now, 0, 0, 0};
  GazeRequest request;
  request.client = kGazeClientName;
  request.key = wish_->key;
  request.p_odom = chosen->p_odom;
  request.priority = params_.least_priority + doubt * (params_.most_priority - params_.least_priority);
  request.deadline_us = now + toStampUs(params_.deadline_s);
  plan.requests.push_back(std::move(request));
  return plan;
}

}  // namespace vismem
