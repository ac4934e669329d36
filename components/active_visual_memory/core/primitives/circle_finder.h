/// @file Circles among remembered segments: chords of one arc. Pure. See M8.
#pragma once

#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct CircleParams {
  double min_radius_m = 0.10;
  double max_radius_m = 2.0;
  double tolerance_m = 0.03;      ///< of a chord's points from the circle
  double max_turn_rad = 1.2;      ///< between neighbouring chords; a hexagon has 1.05
  double max_chord_gap_m = 0.25;  ///< between the ends of neighbouring chords
  double min_coverage = 0.4;      ///< share of the circumference that chords cover
  int min_chords = 5;
  double max_line_width_m = 0.15;  ///< two concentric circles this far apart are both edges of a line
};

/// Circles, by falling coverage. Each edge belongs to at most one of them; a painted circle, whose line has
/// an inner and an outer edge, is one circle.
std::vector<Primitive> findCircles(const std::vector<FloorEdge>& edges, const CircleParams& params);

}  // namespace vismem
