/// @file Pieces of edges, as they were found one by one, as the edges of a map. Pure.
#pragma once

#include <vector>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// Joins pieces of one label that lie on one line and touch (gaps up to `same_place_m`), and leaves out those
/// all of which lies nearer than that to a longer one. Order: of the pieces that come first.
std::vector<MapSegment> joinPieces(const std::vector<MapSegment>& pieces, double same_place_m);

}  // namespace vismem
