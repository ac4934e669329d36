/// @file The part of the search for straight runs that is compiled for each kind of processor. Plain numbers
/// only, because code of other headers must not be compiled twice. Pure. See V1.
#pragma once

#include <cstdint>

#include "common/vision/edge_bits.h"
#include "common/vision/edge_point.h"

namespace vismem {

/// A straight run of edge points, the brighter side on the left.
struct LineRun {
  double ax_px = 0.0, ay_px = 0.0;
  double bx_px = 0.0, by_px = 0.0;
  double points = 0.0;  ///< on the line
};

/// See SolisParams.
struct LineRunParams {
  int first_fit_points = 0;
  double first_fit_rms_px = 0.0;
  double line_tolerance_px = 0.0;
  int maximum_strays = 0;
  double maximum_rms_px = 0.0;
  double piece_length_px = 0.0;
  double alignment_cos = 0.0;
  double alignment_share = 0.0;
};

/// Linked edge points, see EdgePointFinder.
struct LinkedPoints {
  const EdgePoint* points = nullptr;
  const std::int16_t* next = nullptr;
  const std::int32_t* row_begins = nullptr;
  int count = 0;
};

/// Sums over points: their number, of x y, x, y, x x, y y.
struct PointSums {
  double v[6];
};
struct ChainPlace {
  double x, y;  ///< [px] from the pixel where the chain begins
};
struct ChainGradient {
  std::int16_t x, y;
};

/// Room for all points and two blocks more, of each.
struct LineRunWork {
  std::int32_t* starts = nullptr;  ///< of chains, listed
  std::int32_t* tops = nullptr;    ///< of rings, maybe, listed
  std::uint8_t* used = nullptr;
  ChainPlace* place = nullptr;
  ChainGradient* gradient = nullptr;
  PointSums* sums = nullptr;
  std::int32_t* strays = nullptr;
  std::int32_t* agrees = nullptr;
};

/// @param ends of the lists `starts` and `tops`.
/// @param runs room for one run per point.
/// @return the number of runs.
using FindLineRuns = int (*)(const LineRunParams& params, const LinkedPoints& points, EdgeChainEnds ends,
                             const LineRunWork& work, LineRun* runs);

}  // namespace vismem
