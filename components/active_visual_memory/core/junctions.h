/// @file Junctions: where a painted line that joins or crosses an edge parts it. Pure. SPEC M9.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "active_visual_memory/core/line_sides.h"
#include "active_visual_memory/core/memory_element.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

/// From afar a gap of the width of a line is a pixel or two, and what is remembered runs across it. But where
/// paint meets paint there is no edge.
struct JunctionParams {
  bool enabled = true;
  double min_width_m = 0.02;  ///< of the line that parts an edge
  double max_width_m = 0.13;
  double max_angle_rad = 0.10;      ///< between its two sides
  double min_strength_share = 0.5;  ///< contrast of its weaker side over that of the stronger one
  double min_crossing_rad = 0.6;    ///< between it and the edge
  double body_m = 0.15;             ///< it is seen at least this far on the edge's unpainted side
  double reach_m = 0.05;            ///< each of its sides ends so far from the edge at most ..
  double reach_sigmas = 1.0;        ///< .. and so much of its best view's standard deviation ..
  double most_reach_m = 0.12;       ///< .. but never more than this
  /// A confirmed side tells of a line at the width that its label has, though the other one is not seen; and
  /// what ends a little before a circle ends at it.
  bool by_one_side = false;
  double min_part_m = 0.03;  ///< shorter parts of an edge are none
  double max_off_centre_share =
      0.5;  ///< of a circle's radius: an edge further from its middle is no crossing
};

/// Parts the confirmed edges in `segments` where painted lines (two confirmed sides of one label, or see
/// `by_one_side`; as paint of the edge's own kind) reach them from their unpainted side, and
/// where they cross the line of a circle. What reaches an edge or a circle is told to end there. @param
/// elements what the segments were taken from. @param widths of lines. @param id_of the id of the n-th
/// further part (n >= 0) of the edge with an id.
void partAtJunctions(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                     const std::vector<Primitive>& primitives, const LineWidths& widths,
                     const JunctionParams& params,
                     const std::function<std::uint64_t(std::uint64_t, int)>& id_of);

}  // namespace vismem
