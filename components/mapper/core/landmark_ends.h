/// @file Where landmarks end, from what single images showed. Pure. See B6.
#pragma once

#include "mapper/core/landmarks.h"

namespace vismem {

struct LandmarkEndParams {
  double along_px = 1.5;  ///< sigma of an observed end
  double least_sigma_m = 0.01;
  double reach_m = 0.35;       ///< an end is looked for within this of the memory's
  double beyond_sigmas = 3.0;  ///< an edge seen further out than this continues there
  int min_views = 2;           ///< that agree on a closed end, where there are so many
};

/// Sets both ends of each landmark: the place on its line on which most views agree, near ones counting more,
/// or only a bound where more views show the edge to go on. To be called when the graph is near its solution.
void updateEnds(const DriveRecord& record, const LandmarkEndParams& params, MapState& state);

struct OverlapParams {
  double across_m = 0.05;
  double angle_rad = 0.08;
  double least_share = 0.7;     ///< of the shorter one that lies beside the longer one
  double least_piece_m = 0.10;  ///< shorter rests are dropped
  int min_sightings = 3;        ///< of the one that cuts
};

/// One stretch of floor has one edge. A landmark along which another one of a different label lies was seen
/// from afar, across what is between its pieces: it is cut there.
/// @return number of cuts.
int cutOverlaps(const DriveRecord& record, const OverlapParams& params, MapState& state);

}  // namespace vismem
