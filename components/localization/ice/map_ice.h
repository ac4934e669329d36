/// @file The map of segments over Ice.
#pragma once

#include <avm/localization.h>

#include <string>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// @param map as its file has it, stripes not expanded. @param name for people.
avm::MapContents toIce(const SegmentMap& map, const std::string& name);

/// Equal for equal maps, whatever their names: 16 hexadecimal digits of a 64-bit FNV-1a hash of all rows.
std::string mapId(const SegmentMap& map);

}  // namespace vismem
