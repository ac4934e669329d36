/// @file Small painted crosses, whole outline in one look: told as such instead of edge by edge. Pure. SPEC
/// M9.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "active_visual_memory/core/drift_residuals.h"
#include "active_visual_memory/core/line_sides.h"
#include "active_visual_memory/core/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Two short lines that cross, of the width of the lines around, in their course. The notches between its
/// arms are too small for a camera: what it finds are the four slanting edges from arm to arm, and now and
/// then the end of an arm.
struct CrossMarkParams {
  bool enabled = false;
  double most_edge_m = 0.14;      ///< longer edges are none of a cross ..
  double most_reach_m = 0.12;     ///< .. and so far from its middle they are at most
  double least_slant_rad = 0.3;   ///< an edge off the course by more than this runs from arm to arm
  double least_arm_widths = 0.6;  ///< from the middle to an arm's end, in widths of its line ..
  double most_arm_widths = 1.8;
  double most_off_m = 0.03;     ///< edges further from their place are left out
  int least_slanting = 2;       ///< of the four slanting edges so many were found ..
  int least_views = 12;         ///< .. and all edges together in so many images
  double alone_m = 0.20;        ///< a longer edge of the label ..
  double alone_reach_m = 0.15;  ///< .. so near to the middle makes it a junction
};

/// Replaces the edges found of each small cross in `segments` by the ends of its arms. A cross is confirmed
/// as a whole when one of its edges is known to lie on the floor. Nothing happens where the long lines have
/// no course, or lines of the label no width. @param elements what the segments were taken from. @param id_of
/// the id of the n-th arm's end of the cross whose oldest edge has an id.
void tellCrossMarks(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                    const LineWidths& widths, const CourseParams& course, const CrossMarkParams& params,
                    const std::function<std::uint64_t(std::uint64_t, int)>& id_of);

}  // namespace vismem
