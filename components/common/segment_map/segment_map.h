/// @file A map of the world as labelled segments: loading, checking, saving. See L4, L5.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// One row of the map. A row with a width is the centre line of a painted stripe and stands for its two
/// edges.
struct MapSegment {
  Segment3 world;  ///< [m]
  Label label;
  double width_m = 0.0;  ///< 0: an edge
  std::size_t line = 0;  ///< of its file, from 1; 0 for a segment made in code
};

/// Invariant: not empty, all ends finite, all lengths > 0.
struct SegmentMap {
  std::vector<MapSegment> segments;
  bool ends_inside_row = false;  ///< its file ends without a line break after the last row

  /// Plan-view bounding box of all ends [m].
  Eigen::Vector2d low() const;
  Eigen::Vector2d high() const;
};

/// Reads `x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label[,width_m]` after a header line with these names; `#` starts a
/// comment.
/// @throws ConfigError with all problems: FILE:LINE:COLUMN of the character, the value found, and the rule.
SegmentMap loadSegmentMap(const std::filesystem::path& file);
/// The same from a text.
/// @param file_name for messages only.
SegmentMap parseSegmentMap(std::string_view text, const std::string& file_name);

/// Writes a map that loadSegmentMap reads back exactly; the width column only where a row has one.
/// @throws std::runtime_error naming the file when it cannot be written.
void saveSegmentMap(const SegmentMap& map, const std::filesystem::path& file);

/// Replaces each row with a width by its two edges in plan view. Other rows stay unchanged.
/// @param stripe_edges label of a stripe -> label of its edges (Palette::stripes()); a stripe without an
/// entry keeps its own label.
SegmentMap expandStripes(const SegmentMap& map, const std::map<Label, Label>& stripe_edges);

/// True if an observed label matches a map label: equal labels, or `any` in the map. `unknown` matches none.
bool labelFitsMap(const Label& observed, const Label& map_label);

}  // namespace vismem
