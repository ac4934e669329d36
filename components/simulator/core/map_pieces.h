/// @file Joining of collinear pieces into the edges of a map. Pure.
#pragma once

#include <vector>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// Joins collinear pieces of one label with gaps up to `same_place_m`. Leaves out pieces that lie entirely
/// within that distance of a longer one. Order: that of the first piece of each edge.
std::vector<MapSegment> joinPieces(const std::vector<MapSegment>& pieces, double same_place_m);

}  // namespace vismem
