/// @file Residuals of observed segments against remembered lines. Pure. See M6.
#pragma once

#include <cstdint>
#include <vector>

#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/ground/floor_segment.h"

namespace vismem {

/// Adds the residuals of both ends of a piece across a line of MapFilter, and along it where a true end was
/// observed. Along a corridor the ends alone measure the drift.
/// @param id               of the line.
/// @param view             that showed the piece.
/// @param slack_m          sigma of errors that the covariances do not model [m].
/// @param noise            factor of all variances.
/// @param end_inflation    factor of the sigmas of ends.
/// @param max_end_shift_m  ends further apart are different ends [m].
void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                      const TiltView& view, double slack_m, double noise, double end_inflation,
                      double max_end_shift_m, std::vector<LineResidual>& residuals);

}  // namespace vismem
