#include "common/routes/route_follower.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/geometry/angles.h"

namespace vismem {

SimulatedOperator::SimulatedOperator(Route route, const RouteFollowerParams& params)
    : route_(std::move(route)), params_(params) {
  if (!(params.speed_mps > 0.0 && params.max_turn_rate_radps > 0.0 && params.look_ahead_m > 0.0 &&
        params.turn_on_spot_beyond_rad > 0.0)) {
    throw std::invalid_argument("RouteFollowerParams: all values must be positive");
  }
  if (route_.points.size() < 2) throw std::invalid_argument("Route: must have 2 or more way-points");
}

void SimulatedOperator::advance(const Eigen::Vector2d& position) {
  if (!on_route_) {
    along_m_ = nearestPlace(route_, position).along_m;
    on_route_ = true;
  }
  // The look-ahead point advances along the route and never goes back, so that a nearer part of the same
  // route does not cut a corner.
  constexpr double kStep_m = 0.02;
  const double length = route_.length();
  for (double moved = 0.0; moved < length; moved += kStep_m) {
    if ((placeAlong(route_, along_m_).position - position).norm() >= params_.look_ahead_m) return;
    if (!route_.closed && (forth_ ? along_m_ >= length : along_m_ <= 0.0)) forth_ = !forth_;
    along_m_ += forth_ ? kStep_m : -kStep_m;
    if (route_.closed) along_m_ = std::fmod(along_m_ + length, length);
  }
}

DriveCommand SimulatedOperator::drive(const Pose2& T_world_robot) {
  advance(T_world_robot.position());
  const Eigen::Vector2d aim = transform(inverse(T_world_robot), placeAlong(route_, along_m_).position);
  const double angle = std::atan2(aim.y(), aim.x());
  const double w_max = params_.max_turn_rate_radps;
  if (std::abs(angle) > params_.turn_on_spot_beyond_rad) return {0.0, std::copysign(w_max, angle)};
  // Pure pursuit: the arc through the look-ahead point has the curvature 2 y / d^2; higher curvature reduces
  // the speed.
  const double curvature = 2.0 * aim.y() / std::max(aim.squaredNorm(), 1e-6);
  double v = params_.speed_mps * (1.0 - 0.7 * std::abs(angle) / params_.turn_on_spot_beyond_rad);
  if (std::abs(v * curvature) > w_max) v = w_max / std::abs(curvature);
  return {v, std::clamp(v * curvature, -w_max, w_max)};
}

}  // namespace vismem
