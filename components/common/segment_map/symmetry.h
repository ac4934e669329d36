/// @file Rigid motions of the plane that map a segment map onto itself. Pure.
#pragma once

#include <vector>

#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

struct SymmetryParams {
  double tolerance_m = 0.04;    ///< a moved point lies this near a segment of its label
  double point_step_m = 0.25;   ///< spacing of the compared points along a segment
  double angle_rad = 0.1;       ///< directions of a moved segment and its counterpart agree within this
  double least_turn_rad = 0.2;  ///< smaller turns are the identity
  double share = 0.995;         ///< of the map's length that falls on its counterpart: a mark of a few
                                ///< centimetres in a hall does not resolve a pose
};

/// The proper symmetries of a map in plan view: every motion but the identity under which its labelled
/// segments (`share` of their length) fall on segments of the same label. A robot at T_world_robot sees the
/// same as one at S * T_world_robot for each S of the result: no observation of this map tells both apart. A
/// symmetry of a bounded map keeps the length-weighted centroid in place, so that only turns about it count;
/// reflections are none, since a camera tells left from right.
/// @return turns about the centroid, by increasing angle in (0, 2 pi); empty for a map without symmetries.
std::vector<Pose2> symmetriesOf(const SegmentMap& map, const SymmetryParams& params = {});

}  // namespace vismem
