#include "localization/core/gaze_planner.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The health that a race at the right place has, when nothing is wrong.
constexpr double kGoodHealth = 0.7;

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

void GazePlanner::noteAxis(const MemoryUpdate& update) {
  const StampUs now = update.analysis->stamp_us;
  const PanTilt wanted = directionTo(wish_->advice.p_odom, update);
  if (angleBetweenAxes(axisOf(update.analysis->T_robot_camera), wanted) <= params_.seen_rad) {
    wish_->reached_us = now;
  } else if (toSeconds(now - wish_->reached_us) >= params_.deadline_s) {
    // A stuck unit, or other clients that are more urgent.
    advisor_.giveUp(wanted, update);
    wish_->reached_us = now;
  }
}

GazePlan GazePlanner::plan(const PoseEstimate& estimate, const MemoryUpdate& update) {
  GazePlan plan;
  const StampUs now = update.analysis->stamp_us;
  // A new epoch clears the places of gaze; a source that began anew has other stamps.
  if (update.snapshot->epoch != epoch_ || now < last_stamp_us_) {
    if (wish_ && now >= last_stamp_us_) plan.withdrawn.push_back(wish_->key);
    wish_.reset();
    doubted_us_.reset();
    epoch_ = update.snapshot->epoch;
  }
  last_stamp_us_ = now;
  const double doubt = GazePlanner::doubt(estimate);
  if (doubt >= params_.doubt_above) {
    // What was seen before doubt began tells nothing any more.
    if (!doubted_us_) advisor_.forget();
    doubted_us_ = now;
  }
  advisor_.look(update);
  if (doubted_us_ && toSeconds(now - *doubted_us_) > params_.confirm_s) doubted_us_.reset();
  if (!doubted_us_) {
    if (wish_) plan.withdrawn.push_back(wish_->key);
    wish_.reset();
    return plan;
  }
  if (wish_) noteAxis(update);
  const std::vector<GazeAdvice> advice = advisor_.advise(estimate, update);
  if (advice.empty()) return plan;
  const GazeAdvice& best = advice.front();
  const bool is_elsewhere =
      wish_ && angleBetweenAxes(best.direction, directionTo(wish_->advice.p_odom, update)) > params_.move_rad;
  const bool is_old = wish_ && toSeconds(now - wish_->asked_us) >= 0.5 * params_.deadline_s;
  if (wish_ && !is_elsewhere && !is_old) return plan;
  // The same key: a wish that moves keeps its salience, and the head turns without a stop.
  const std::string key = wish_ ? wish_->key : "look " + std::to_string(++asked_);
  wish_ = Wish{key, best, now, wish_ && !is_elsewhere ? wish_->reached_us : now};
  GazeRequest request;
  request.client = kGazeClientName;
  request.key = key;
  request.p_odom = best.p_odom;
  request.priority = params_.least_priority + doubt * (params_.most_priority - params_.least_priority);
  request.deadline_us = now + toStampUs(params_.deadline_s);
  plan.requests.push_back(std::move(request));
  return plan;
}

}  // namespace vismem
