/// @file Residuals of observed segments against remembered lines and against a dominant direction. Pure. See
/// M6.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/ground/floor_segment.h"

namespace vismem {

/// Adds the residuals of both ends of a piece across a line of MapFilter, and along it where a true end was
/// observed.
/// @param id               of the line.
/// @param view             that showed the piece.
/// @param slack_m          sigma of errors that the covariances do not model [m].
/// @param noise            factor of all variances.
/// @param end_inflation    factor of the sigmas of ends.
/// @param max_end_shift_m  ends further apart are different ends [m].
void addLineResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                      const TiltView& view, double slack_m, double noise, double end_inflation,
                      double max_end_shift_m, std::vector<LineResidual>& residuals);

/// Variance of an end along a direction without the contribution of camera pitch and roll, which are common
/// to the image and part of the state [m^2].
double ownVariance(const Eigen::Vector2d& direction, const FloorEnd& end, double pitch_sigma_rad);

struct DirectionDeviation {
  double turn_rad = 0.0;
  double variance = 0.0;  ///< [rad^2]
};

/// Turn of the long lines of one image against a known direction, with the variance of the per-frame tilt.
/// @return empty without long lines.
std::optional<DirectionDeviation> directionDeviation(std::span<const FloorSegment> floor,
                                                     const TiltView& view,
                                                     const DominantDirectionParams& params,
                                                     double dominant_direction_rad, double per_frame_rad);

}  // namespace vismem
