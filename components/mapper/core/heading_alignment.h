/// @file The headings of a drive by the lines it saw, where a place has right angles. Pure. See B6.
#pragma once

#include <numbers>
#include <optional>

#include "mapper/core/landmarks.h"
#include "mapper/core/map_graph.h"

namespace vismem {

struct HeadingParams {
  double range_m = 4.0;    ///< lines count up to here ..
  double least_m = 0.30;   ///< .. and from this length on
  double line_rad = 0.04;  ///< sigma of the direction of a line in one image, the tilt of each frame included
  double gate_rad = 0.30;  ///< lines further off follow no dominant direction
  double start_m = 2.0;    ///< way over which dead reckoning gives the dominant direction
  double near_rad = 0.10;  ///< a line this near to it follows it
  double least_share = 0.6;  ///< of all length that must do so, or nothing is changed
};

/// Dead reckoning turns by tens of degrees in a lap on legs, and the graph then ends in another minimum. Each
/// line gives the heading up to a quarter turn: a filter of the heading error over the drive keeps the
/// quarter. To be called on initialState.
/// @param odometry  errors of the heading.
/// @return whether the place has a dominant direction; else the poses stay as they are.
bool alignHeadings(const DriveRecord& record, const OdometryErrors& odometry, const HeadingParams& params,
                   MapState& state);

/// The direction that most of the landmarks' length follows, modulo 90 degrees [rad].
/// @return empty if less than this share of the length does.
std::optional<double> dominantDirectionOf(const MapState& state, double gate_rad, double least_share = 0.6);

}  // namespace vismem
