#include "experiments/core/corridor_follower.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/plane.h"
#include "common/geometry/pose.h"

namespace vismem {
namespace {

/// @return whether a ray intersects a segment within the range.
bool intersects(const Eigen::Vector2d& from, double heading_rad, double range_m, const Segment2& wall) {
  const Eigen::Vector2d d{std::cos(heading_rad), std::sin(heading_rad)};
  const Eigen::Vector2d e = wall.b - wall.a;
  const double turn = cross2(d, e);
  if (std::abs(turn) < 1e-9) return false;
  const Eigen::Vector2d to = wall.a - from;
  const double along = cross2(to, e) / turn;
  const double share = cross2(to, d) / turn;
  return along >= 0.0 && along <= range_m && share >= 0.0 && share <= 1.0;
}

/// @return whether a wall is known on this side of the pose (+1: left), across small gaps between its pieces.
bool hasWall(const Pose2& pose, double side, double range_m, std::span<const Segment2> walls) {
  constexpr double kSpread_rad = 0.3;
  for (const double off : {0.0, -kSpread_rad, kSpread_rad}) {
    const double heading = pose.theta + side * 0.5 * std::numbers::pi + off;
    for (const Segment2& wall : walls) {
      if (intersects(pose.position(), heading, range_m, wall)) return true;
    }
  }
  return false;
}

}  // namespace

ArcCommand CorridorFollower::follow(std::span<const Segment2> walls, std::span<const Segment2> uncertain) {
  const auto known = [&](const Pose2& pose, double side) {
    return hasWall(pose, side, params_.widest_m, walls) || hasWall(pose, side, params_.widest_m, uncertain);
  };
  constexpr double kStep_m = 0.1;
  const int steps = static_cast<int>(std::lround(params_.reach_m / kStep_m));
  double best_score = -1e9;
  double best_curvature = 0.0;
  double best_free = 0.0;
  const int arcs = static_cast<int>(std::lround(params_.largest_curvature / params_.curvature_step));
  for (int arc = -arcs; arc <= arcs; ++arc) {
    const double curvature = arc * params_.curvature_step;
    Pose2 pose;
    double free = 0.0;
    double room = 0.0;
    for (int i = 0; i < steps; ++i) {
      pose = pose * Pose2{kStep_m * std::cos(0.5 * curvature * kStep_m),
                          kStep_m * std::sin(0.5 * curvature * kStep_m), curvature * kStep_m};
      double nearest = params_.desired_clearance_m;
      for (const Segment2& wall : walls)
        nearest = std::min(nearest, distanceToSegment(pose.position(), wall));
      if (nearest < params_.clearance_m) break;
      const bool blind = (i + 1) * kStep_m <= params_.blind_m;
      if (!blind && !(known(pose, 1.0) && known(pose, -1.0))) {
        break;
      }
      free += kStep_m;
      room += nearest / params_.desired_clearance_m / steps;
    }
    const double score = free / params_.reach_m + params_.clearance_weight * room -
                         params_.straight_weight * std::abs(curvature) -
                         params_.steady_weight * std::abs(curvature - last_curvature_);
    if (score > best_score) {
      best_score = score;
      best_curvature = curvature;
      best_free = free;
    }
  }
  last_curvature_ = best_curvature;
  ArcCommand command;
  command.free_m = best_free;
  if (best_free <= params_.blind_m + 0.5 * kStep_m) return command;  // no corridor known: stand
  command.v_mps = params_.speed_mps;
  const double turn = std::abs(best_curvature) * command.v_mps;
  command.w_radps = std::copysign(std::min(turn, params_.max_turn_radps), best_curvature);
  return command;
}

}  // namespace vismem
