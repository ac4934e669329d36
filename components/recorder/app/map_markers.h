/// @file A map as markers. Pure.
#pragma once

#include "common/segment_map/segment_map.h"
#include "recorder/core/log_message.h"

namespace vismem {

/// /map, latched: lines in the frame "map", one colour a label; those with a width are drawn so wide.
RecordedMessage mapMarkers(const SegmentMap& map);

}  // namespace vismem
