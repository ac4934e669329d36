/// @file Painted stripes in a map of edges. Pure. DESIGN 14.
#pragma once

#include <map>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// Puts the middle of a stripe, with its width, in place of its two edges on the floor: parallel edges of a
/// stripe's edge label 3 to 12 cm apart, the nearest first. Stripes that meet are made to touch; edges of a
/// stripe that have no partner stay if they are longer than its width (ends and corners of stripes go).
/// @param stripe_edges name of a stripe -> label of its edges (Palette::stripes()).
SegmentMap joinStripes(const SegmentMap& edges, const std::map<Label, Label>& stripe_edges);

}  // namespace vismem
