/// @file Ends that landmarks share: corners, and where one edge passes into the next. Pure. See B6.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapper/core/landmarks.h"

namespace vismem {

struct CornerJoinParams {
  double least_angle_rad = 0.35;  ///< between the lines of a corner
  double reach_m = 0.12;          ///< from an end to the intersection of both lines
  double short_m = 0.05;          ///< the same of a closed end that stops before it
  double open_m = 0.60;           ///< the same between two obstacles of which no image saw the ends there ..
  double open_share = 0.3;        ///< .. and of the length of each
  double across_m = 0.04;         ///< between the lines of edges that follow each other
  double gap_m = 0.10;            ///< between their ends
  double angle_rad = 0.06;        ///< between their directions
  /// Labels of the feet of walls and things, which form corners with each other ("*_foot": any beginning);
  /// others form corners with their own label only.
  std::vector<std::string> obstacles{"skirting", "*_foot"};
  std::vector<std::uint64_t> keep{};  ///< ids of landmarks whose ends stay
};

/// Moves ends to where they meet: two lines fix a corner better than their ends do. To be called after the
/// last solve.
/// @return number of ends that moved.
int joinCorners(const CornerJoinParams& params, MapState& state);

}  // namespace vismem
