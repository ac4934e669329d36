/// @file Published ends of edges that share a corner, moved there. Pure. See M9.
#pragma once

#include <span>
#include <vector>

#include "active_visual_memory/core/memory/edge_corner.h"

namespace vismem {

/// Moves the confirmed ends of `segments` that share a corner to the intersection of their lines, the nearest
/// first. Along an edge with its brighter side on the left, the next edge of the same surface begins where
/// this one ends: an end b belongs to an end a. Censored ends have no corner.
/// @param elements  that the segments were taken from.
void joinAtCorners(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const CornerParams& params);

}  // namespace vismem
