/// @file Follows a corridor by the feet of its walls, from whatever knows of them. Pure. SPEC E2.
#pragma once

#include <span>

#include "common/geometry/segment.h"

namespace vismem {

struct DriveWish {
  double v_mps = 0.0;
  double w_radps = 0.0;
  double free_m = 0.0;  ///< of the chosen arc
};

/// Chooses the arc on which the robot gets furthest ahead without coming near a wall that it knows of. It
/// goes on only where it knows of a wall on either side: beyond the part before its feet, which no camera on
/// it sees, what it does not know of is no corridor. *Pure value*; remembers its last choice.
class CorridorFollower {
 public:
  struct Params {
    double speed_mps = 0.25;
    double max_turn_radps = 0.6;
    double reach_m = 2.0;            ///< arcs are looked at so far
    double blind_m = 1.5;            ///< nearer, no walls need to be known
    double widest_m = 1.6;           ///< a wall further aside is none of this corridor's
    double clearance_m = 0.30;       ///< of the robot's middle from a wall, at least
    double wished_m = 0.60;          ///< more is worth nothing
    double largest_curvature = 1.6;  ///< [1/m]
    double curvature_step = 0.1;
    double clearance_weight = 0.8;
    double straight_weight = 0.05;  ///< against curvature
    double steady_weight = 0.10;    ///< against a change of it
  };

  explicit CorridorFollower(const Params& params) : params_(params) {}

  /// @param walls on the floor, in the robot's frame [m]. @param supposed further ones that are not sure to
  /// be where they seem: they make a side known, and bar no way.
  DriveWish follow(std::span<const Segment2> walls, std::span<const Segment2> supposed);

 private:
  Params params_;
  double last_curvature_ = 0.0;
};

}  // namespace vismem
