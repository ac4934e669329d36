/// @file Corners: where the edges of one surface meet. Pure. SPEC M9.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// An edge's line is known much better than its ends, of which images show a pixel or two too little or too
/// much. Two ends that meet are told where their lines cross.
struct CornerParams {
  bool enabled = true;
  double min_angle_rad = 0.4;  ///< between both edges, and to a fold
  double reach_m = 0.03;       ///< an end lies so far from the corner ..
  double reach_sigmas = 1.0;   ///< .. and so much of its best view's standard deviation ..
  double most_reach_m = 0.12;  ///< .. but never more than this
  // What is confirmed by its corners:
  int min_views = 3;           ///< of either end
  double min_length_m = 0.12;  ///< the direction of less is that of its ends' errors
};

/// Publishes as confirmed what runs from the end of one confirmed edge of the same thing to the beginning of
/// another one: both its ends lie on the floor, so all of it does. An image from one place is enough for
/// that. Only what has a label; nothing that was seen to stand.
void confirmBetweenCorners(std::span<MemoryElement> elements, const CornerParams& params);

/// Moves the confirmed ends that meet in `segments`. Walking along an edge with its brighter side on the
/// left, the next edge of the same surface begins where this one ends: an end b meets an end a. Ends that are
/// hidden or cut by the border meet nothing. @param elements what the segments were taken from.
void meetAtCorners(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const CornerParams& params);

}  // namespace vismem
