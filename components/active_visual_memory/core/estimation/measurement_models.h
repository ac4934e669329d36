/// @file Residuals of observed segments against remembered lines. Pure. See M6.
#pragma once

#include <cstdint>
#include <vector>

#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/ground/floor_segment.h"

namespace vismem {

/// Adds the residuals of both ends of an observed piece across a line of MapFilter.
/// @param id       of the line.
/// @param view     that showed the piece.
/// @param slack_m  sigma of errors that the covariances do not model [m].
/// @param noise    factor of all variances.
void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& observed,
                      const TiltView& view, double slack_m, double noise,
                      std::vector<LineResidual>& residuals);

}  // namespace vismem
