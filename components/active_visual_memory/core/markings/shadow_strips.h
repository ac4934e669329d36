/// @file The far edge of the shadow along a box, which takes the label of the box. Pure. See M1.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/memory/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Along the foot of a box a strip of floor lies in its shadow. At a distance the strip is a few pixels wide,
/// and its far edge has floor and box beside it, the label of the foot. A dark line marking differs from it:
/// one floor on both sides, and edges of equal contrast.
struct ShadowParams {
  double width_m = 0.25;         ///< of the strip, at most
  double max_angle_rad = 0.15;   ///< between its two edges
  double strength_share = 0.7;   ///< contrast of its far edge over that of the foot, at most
  double min_difference = 30.0;  ///< grey levels of some channel, between the surfaces beyond both edges
};

/// Withdraws the confirmation of the far edges of such strips.
/// @param elements  that the segments were taken from.
void withdrawShadows(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                     const ShadowParams& params);

}  // namespace vismem
