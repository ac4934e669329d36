/// @file Whether a map and the labels of a palette belong together. Pure. See L4, V3.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"

namespace vismem {

/// The labels that a palette can give.
struct PaletteLabels {
  std::set<Label> edges;           ///< of pairs of classes
  std::map<Label, Label> stripes;  ///< name of a stripe in maps -> label of its edges
  std::set<Label> upright;         ///< edges that do not border the floor: a map of the floor may lack them
};

/// Looks for mistakes that leave a map readable but of little use: labels that no pair of the palette names,
/// pairs that no row of the map has, rows that repeat, a last row that may be cut off.
/// @param map_name      file of the map, for messages.
/// @param palette_name  file of the palette, for messages.
/// @return one warning a line, with file, line and the nearest name; empty for a sound map.
/// @throws ConfigError when no row has a label that the palette can give: nothing is left to localize by.
std::vector<std::string> checkMap(const SegmentMap& map, const std::string& map_name,
                                  const PaletteLabels& labels, const std::string& palette_name);

}  // namespace vismem
