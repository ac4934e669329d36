/// @file A map of the world: labelled segments, and how one is loaded and checked. SPEC L4, L5; DESIGN 14.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// One row of the map. With a width the row is the middle of a painted stripe and stands for two edges.
struct MapSegment {
  Segment3 world;  ///< [m]
  Label label;
  double width_m = 0.0;  ///< 0: an edge
};

/// Invariant: not empty, all ends finite, all lengths > 0.
struct SegmentMap {
  std::vector<MapSegment> segments;

  /// Plan-view bounding box of all ends [m].
  Eigen::Vector2d low() const;
  Eigen::Vector2d high() const;
};

/// Reads `x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label[,width_m]` (that header line first; `#` begins a comment).
/// @throws ConfigError with every problem: FILE:LINE:COLUMN (of the character), what was found, what was
/// expected.
SegmentMap loadSegmentMap(const std::filesystem::path& file);
/// As loadSegmentMap on a text. @param file_name is used in messages only.
SegmentMap parseSegmentMap(std::string_view text, const std::string& file_name);

/// Writes a map that loadSegmentMap reads back exactly; the width column only where a row has one.
/// @throws std::runtime_error naming the file when it cannot be written.
void saveSegmentMap(const SegmentMap& map, const std::filesystem::path& file);

/// Turns stripes into their edges: a row with a width becomes two edges beside it, in plan view, labelled
/// stripe_edges[label] (the row's own label where there is no entry). Other rows stay as they are. DESIGN 14.
/// @param stripe_edges name of a stripe -> label of its edges (Palette::stripes()).
SegmentMap expandStripes(const SegmentMap& map, const std::map<Label, Label>& stripe_edges);

/// Whether an observed label can be a map line of another: equal, or the map says `any`; `unknown` is
/// nothing.
bool labelFitsMap(const Label& observed, const Label& map_label);

}  // namespace vismem
