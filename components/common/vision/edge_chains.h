/// @file Chains of edge points, followed along the edge. Pure. SPEC V1.
#pragma once

#include <cstdint>
#include <vector>

#include "common/vision/edge_points.h"

namespace vismem {

struct ChainPoint {
  float x = 0.0F;  ///< sub-pixel [px]
  float y = 0.0F;
  std::int32_t index = 0;  ///< into the planes
};

/// Follows the edge points of `planes` into chains, each point used once (but the first
/// ones of a ring, which come again at its end); the brighter side is on the left of
/// the way. A step goes to one of the three neighbours ahead in the class (of eight) of the edge's direction,
/// if its own direction is at most about one class off; up to `gap_px` missing points are jumped straight on.
/// @param chains replaced: points of all chains, one after the other.
/// @param begins replaced: where each chain begins, and the end of the last one.
/// Clears planes.is_edge.
void followChains(EdgePlanes& planes, int gap_px, std::vector<ChainPoint>& chains,
                  std::vector<std::int32_t>& begins);

}  // namespace vismem
