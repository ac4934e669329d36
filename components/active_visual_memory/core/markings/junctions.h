/// @file Junctions: where a line marking that joins or crosses an edge splits it. Pure. See M9.
#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <span>
#include <vector>

#include "active_visual_memory/core/markings/line_marking.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

/// At a distance the gap that a joining line leaves in an edge is a pixel or two wide, and the remembered
/// edge runs across it. But where paint meets paint there is no edge.
struct JunctionParams {
  bool enabled = true;
  LineWidthRange range;             ///< of the joining line
  double min_strength_share = 0.5;  ///< contrast of its weaker edge over that of the stronger one
  double min_crossing_rad = 0.6;    ///< between it and the edge
  double body_m = 0.15;             ///< least length of it on the unpainted side of the edge
  EndReach reach{0.05, 1.0, 0.12};  ///< of the ends of its edges to the edge
  /// One confirmed edge represents a line of the width of its label; and ends shortly before a circle end at
  /// it.
  bool by_one_side = false;
  double min_part_m = 0.03;  ///< shorter parts of an edge are dropped
  double max_off_centre_share =
      0.5;  ///< of the radius: an edge further from the centre of a circle does not cross it
};

/// Splits the confirmed edges in `segments` where line markings of their label reach them from the unpainted
/// side, and where they cross the line of a circle. Ends of the joining edges are moved to the edge or
/// circle.
/// @param edges   the segments with their elements.
/// @param widths  of line markings by label.
/// @param id_of   id of the n-th further part (n >= 0) of the edge with an id.
void splitAtJunctions(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> edges,
                      std::span<const Primitive> primitives, const LineWidths& widths,
                      const JunctionParams& params,
                      const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                      std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
