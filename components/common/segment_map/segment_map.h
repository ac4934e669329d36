/// @file A map of the world: labelled segments, and how one is loaded and checked. SPEC L4, L5; DESIGN 14.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// One row of the map. With a width the row is the middle of a painted stripe and stands for two edges.
struct MapSegment {
  Segment3 world;       ///< [m]
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
/// @throws ConfigError with every problem: file, line, column, what was found, what was expected.
SegmentMap loadSegmentMap(const std::filesystem::path& file);

}  // namespace vismem
