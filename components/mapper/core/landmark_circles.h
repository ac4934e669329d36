/// @file Painted circles as landmarks of the graph, and as chords of the map. Pure. See B6, M8, M9.
#pragma once

#include "mapper/core/landmarks.h"
#include "mapper/core/seen_circles.h"

namespace vismem {

struct CircleJoinParams {
  SeenCircleParams seen;
  double least_share = 0.5;  ///< of a landmark's sightings that are chords of the circle it belongs to ..
  double leftover_m = 0.13;  ///< .. or it lies this near to its edges all along, where they were seen
};

/// Sets MapState::circles: a line along an arc is none. Images from other places show other chords, and what
/// they have in common lies beside the curve. Lines that are chords of a circle are removed, and the graph
/// holds the poses by the curve instead. @return number of circles.
int takeCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state);

/// The same, and adds their regular chords of both edges where images showed them, for the map. To be called
/// near the solution.
int joinCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state);

}  // namespace vismem
