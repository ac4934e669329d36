/// @file Parallelograms and triangles: edges whose ends share corners. Pure. See M8, M9.
#pragma once

#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct PolygonParams {
  double min_side_m = 0.12;
  double max_side_m = 2.5;
  double corner_gap_m = 0.08;   ///< from an edge's end to the corner, plus half a stripe's width
  double corner_share = 0.05;   ///< of the edge's length, added
  double min_corner_rad = 0.4;  ///< 23 degrees
  double parallel_rad = 0.14;   ///< 8 degrees
  double closing_m = 0.06;      ///< of the fourth corner from where the other three put it
  double closing_share = 0.06;  ///< of the longest side, added
  double broken_gap_m = 0.6;    ///< two collinear pieces this far apart may be one broken side
  double broken_offset_m = 0.025;
  double broken_angle_rad = 0.08;
};

/// Parallelograms and triangles, complete ones and parallelograms of which three corners are seen. The sides
/// of one shape turn the same side to its inside (brighter or darker); two collinear pieces may be one side.
/// Every edge belongs to any number of them: the caller chooses.
std::vector<Primitive> findPolygons(const std::vector<FloorEdge>& edges, const PolygonParams& params);

}  // namespace vismem
