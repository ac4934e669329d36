/// @file Follows a corridor by the lower edges of its walls. Pure. See E2.
#pragma once

#include <span>

#include "common/geometry/segment.h"

namespace vismem {

/// Velocities along the chosen arc.
struct ArcCommand {
  double v_mps = 0.0;
  double w_radps = 0.0;
  double free_m = 0.0;  ///< free length of the arc
};

/// Chooses the arc with the longest free length. An arc is free while it keeps its clearance from all known
/// walls and, beyond the blind range in front of the robot, has a known wall on either side.
/// *Single-threaded*; keeps its last choice.
class CorridorFollower {
 public:
  struct Params {
    double speed_mps = 0.25;
    double max_turn_radps = 0.6;
    double reach_m = 2.0;               ///< length of the arcs
    double blind_m = 1.5;               ///< range without required walls: no camera on the robot sees it
    double widest_m = 1.6;              ///< largest distance of a corridor's wall to the side
    double clearance_m = 0.30;          ///< least distance of the robot's middle from a wall
    double desired_clearance_m = 0.60;  ///< larger clearances score the same
    double largest_curvature = 1.6;     ///< [1/m]
    double curvature_step = 0.1;
    double clearance_weight = 0.8;
    double straight_weight = 0.05;  ///< against curvature
    double steady_weight = 0.10;    ///< against a change of it
  };

  explicit CorridorFollower(const Params& params) : params_(params) {}

  /// @param walls on the floor, in the robot's frame [m].
  /// @param uncertain unconfirmed walls: they count as a known side but do not block an arc.
  ArcCommand follow(std::span<const Segment2> walls, std::span<const Segment2> uncertain);

 private:
  Params params_;
  double last_curvature_ = 0.0;
};

}  // namespace vismem
