/// @file Painted stripes in a map of edges. Pure.
#pragma once

#include <map>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// Replaces the two edges of a stripe on the floor by its middle line with its width. A pair has a stripe's
/// edge label, is parallel and 3 to 12 cm apart; the nearest pairs are joined first. Stripes are extended to
/// each other at junctions. Unpaired edges stay if they are longer than the stripe's width; shorter ones are
/// ends and corners of stripes.
/// @param stripe_edges name of a stripe -> label of its edges (Palette::stripes()).
SegmentMap joinStripes(const SegmentMap& edges, const std::map<Label, Label>& stripe_edges);

}  // namespace vismem
