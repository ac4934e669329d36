/// @file The far side of the strip of shadow along a box, which takes the label of the box. Pure. SPEC M1.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Along the foot of a box a strip of floor lies in its shadow. From afar the strip is a few pixels wide,
/// what is seen beside its far side is the floor and the box, and it is called a foot of the box, too. What
/// tells it from a dark line of paint: a strip of paint has one floor on both sides, and edges as strong.
struct ShadowParams {
  bool enabled = true;
  double width_m = 0.25;         ///< of the strip, at most
  double max_angle_rad = 0.15;   ///< between its two sides
  double strength_share = 0.7;   ///< contrast of its far side over that of the foot, at most
  double min_difference = 30.0;  ///< grey levels of some channel, between what lies beyond either side
};

/// Takes back the confirmation of the far sides of such strips. @param elements what the segments were taken
/// from.
void withdrawShadows(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                     const ShadowParams& params);

}  // namespace vismem
