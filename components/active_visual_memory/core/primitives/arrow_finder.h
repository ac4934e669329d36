/// @file Arrows: a shaft and two heads that share its tip. Pure. See M8.
#pragma once

#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

struct ArrowParams {
  double gap_m = 0.12;         ///< from the tip to the ends of shaft and heads, plus half their widths
  double min_head_rad = 0.35;  ///< between head and shaft, 20 degrees
  double max_head_rad = 1.22;  ///< 70 degrees
  double symmetry_rad = 0.21;  ///< difference between the angles of both heads
  double head_ratio = 0.65;    ///< of the shorter head to the longer
  double shaft_ratio = 1.2;    ///< least of the shaft to the heads
  double min_head_m = 0.08;
};

/// Arrows among strokes (edges or stripes).
/// @param max_shaft_m  longer strokes are no shafts.
std::vector<Primitive> findArrows(const std::vector<FloorEdge>& strokes, const ArrowParams& params,
                                  double max_shaft_m);

}  // namespace vismem
