/// @file Small painted crosses (penalty spots), published as the ends of their arms. Pure. See M9.
#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <span>
#include <vector>

#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "active_visual_memory/core/markings/line_marking.h"

namespace vismem {

/// Two short lines that cross along the dominant direction, of the width of the lines around. The notches
/// between the arms are below the resolution of the image: detected are the four slanting edges from arm to
/// arm, and sometimes the end of an arm.
struct CrossSpotParams {
  bool enabled = false;
  double most_edge_m = 0.14;      ///< longer edges do not belong to a cross
  double most_reach_m = 0.12;     ///< nor edges further from its centre
  double least_slant_rad = 0.3;   ///< off the dominant direction: a steeper edge runs from arm to arm
  double least_arm_widths = 0.6;  ///< length of an arm from the centre, in widths of its line, at least
  double most_arm_widths = 1.8;   ///< and at most
  double most_off_m = 0.03;       ///< residual beyond which an edge is left out of the fit
  int least_slanting = 2;         ///< of the four slanting edges that must be observed
  int least_views = 12;           ///< of all edges together
  double alone_m = 0.20;          ///< an edge of the label of at least this length ..
  double alone_reach_m = 0.15;    ///< .. within this distance of the centre makes it a junction
};

/// Replaces the edges of each small cross by the ends of its arms. A cross is confirmed as a whole if one of
/// its edges is known to lie on the floor. Nothing changes without a dominant direction or a width of the
/// label.
/// @param edges  the segments with their elements.
/// @param id_of  id of the n-th arm end of the cross whose oldest edge has an id.
void replaceCrossSpots(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> edges,
                       const LineWidths& widths, const DominantDirectionParams& dominant_direction,
                       const CrossSpotParams& params,
                       const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                       std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
