/// @file Line markings as stripes: pairs of antiparallel edges. Pure. See M8.
#pragma once

#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct StripeParams {
  double min_width_m = 0.008;  ///< distant lines are remembered narrower than they are
  double max_width_m = 0.13;
  double max_angle_rad = 0.10;   ///< between the edges
  double min_overlap = 0.5;      ///< of the shorter edge
  double min_slenderness = 2.5;  ///< length to width: shorter things are patches
  double max_gap_m = 0.25;       ///< pieces of one painted line this far apart are joined
  double max_offset_m = 0.03;    ///< of their middle lines
};

/// The middle lines of stripes with their width, longest first. Their `segments` are those of both edges; an
/// edge broken on one side only still makes one stripe.
std::vector<FloorEdge> findStripes(const std::vector<FloorEdge>& edges, const StripeParams& params);

Primitive stripePrimitive(const FloorEdge& stripe);

}  // namespace vismem
