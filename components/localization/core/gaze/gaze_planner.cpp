#include "localization/core/gaze/gaze_planner.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Health of a race at the true pose.
constexpr double kTrustedHealth = 0.7;

/// From the camera to a place, as pan and tilt of an axis on the robot.
PanTilt directionTo(const Eigen::Vector3d& p_odom, const MemoryUpdate& update) {
  const Eigen::Vector3d ray = transform(inverse(update.analysis->T_odom_robot), p_odom) -
                              update.analysis->T_robot_camera.translation();
  return {std::atan2(ray.y(), ray.x()), std::atan2(ray.z(), ray.head<2>().norm())};
}

}  // namespace

int carryOut(const GazePlan& plan, GazeClient& client) {
  int rejected = 0;
  if (plan.withdrawn && !client.withdraw(kGazeClientName, *plan.withdrawn).ok()) ++rejected;
  if (plan.request && !client.request(*plan.request).ok()) ++rejected;
  return rejected;
}

GazePlanner::GazePlanner(const GazePlannerParams& params, const LikelihoodParams& likelihood,
                         const MapParams& map, const SegmentMap& map_edges)
    : params_(params), advisor_(params.advisor, likelihood, map, map_edges) {}

double GazePlanner::uncertainty(const PoseEstimate& estimate) {
  double trust = 0.0;
  for (const RaceReport& race : estimate.races) {
    // Support is low-pass filtered; the present health reacts at once.
    if (race.winner) {
      trust = race.weight * std::min(estimate.support, race.health / kTrustedHealth);
    }
  }
  return 1.0 - std::clamp(trust, 0.0, 1.0);
}

std::optional<GazeAdvice> GazePlanner::requested() const {
  return standing_ ? std::optional<GazeAdvice>(standing_->advice) : std::nullopt;
}

void GazePlanner::updateReached(const MemoryUpdate& update) {
  const StampUs now = update.analysis->stamp_us;
  const PanTilt wanted = directionTo(standing_->advice.p_odom, update);
  if (angleBetweenAxes(axisOf(update.analysis->T_robot_camera), wanted) <= params_.seen_rad) {
    standing_->reached_us = now;
  } else if (toSeconds(now - standing_->reached_us) >= params_.deadline_s) {
    // A stuck unit, or a more urgent client.
    advisor_.abandon(wanted, update);
    standing_->reached_us = now;
  }
}

GazePlan GazePlanner::plan(const PoseEstimate& estimate, const MemoryUpdate& update) {
  GazePlan plan;
  const StampUs now = update.analysis->stamp_us;
  // A new epoch clears the requests of gaze; a restarted source has other stamps.
  if (update.snapshot->epoch != epoch_ || now < last_stamp_us_) {
    if (standing_ && now >= last_stamp_us_) plan.withdrawn = standing_->key;
    standing_.reset();
    uncertain_us_.reset();
    epoch_ = update.snapshot->epoch;
  }
  last_stamp_us_ = now;
  const double uncertainty = GazePlanner::uncertainty(estimate);
  if (uncertainty >= params_.uncertainty_above) {
    // Views before the pose became uncertain do not count.
    if (!uncertain_us_) advisor_.reset();
    uncertain_us_ = now;
  }
  advisor_.addView(update);
  if (uncertain_us_ && toSeconds(now - *uncertain_us_) > params_.confirm_s) uncertain_us_.reset();
  if (!uncertain_us_) {
    if (standing_) plan.withdrawn = standing_->key;
    standing_.reset();
    return plan;
  }
  if (standing_) updateReached(update);
  const std::vector<GazeAdvice> advice = advisor_.advise(estimate, update);
  if (advice.empty()) return plan;
  const GazeAdvice& best = advice.front();
  const bool is_elsewhere =
      standing_ &&
      angleBetweenAxes(best.direction, directionTo(standing_->advice.p_odom, update)) > params_.move_rad;
  const bool is_old = standing_ && toSeconds(now - standing_->asked_us) >= 0.5 * params_.deadline_s;
  if (standing_ && !is_elsewhere && !is_old) return plan;
  // With the same key a request that moves keeps its salience, and the head turns without a stop.
  const std::string key = standing_ ? standing_->key : "look " + std::to_string(++asked_);
  standing_ = Standing{key, best, now, standing_ && !is_elsewhere ? standing_->reached_us : now};
  GazeRequest& request = plan.request.emplace();
  request.client = kGazeClientName;
  request.key = key;
  request.p_odom = best.p_odom;
  request.priority = params_.least_priority + uncertainty * (params_.most_priority - params_.least_priority);
  request.deadline_us = now + toStampUs(params_.deadline_s);
  return plan;
}

}  // namespace vismem
