/// @file Circles among the landmarks: the chords that single images saw of one are fitted together. Pure. See
/// B6, M8, M9.
#pragma once

#include "active_visual_memory/core/markings/circle_marking.h"
#include "active_visual_memory/core/primitives/circle_finder.h"
#include "mapper/core/landmarks.h"

namespace vismem {

struct CircleJoinParams {
  CircleParams finder;
  CircleMarkingParams chords;
  double kernel_m = 0.02;       ///< Cauchy, of the distance of a seen chord from the circle
  double least_share = 0.5;     ///< of a landmark's sightings that are chords of the circle it belongs to ..
  double leftover_m = 0.13;     ///< .. or it lies this near to its edges all along, where they were seen
  int least_sightings = 3;      ///< of a chord that is mapped
  double least_sigma_m = 0.01;  ///< of a seen chord across
};

/// A line along an arc is none: images from other places show other chords, and what they have in common lies
/// beside the curve. Landmarks of a circle become regular chords of both its edges, with
/// LineLandmark::is_chord, fixed to one keyframe. To be called near the solution: they pull no pose any more.
/// @return number of circles.
int joinCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state);

}  // namespace vismem
