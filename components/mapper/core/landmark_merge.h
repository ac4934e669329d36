/// @file Landmarks that are one edge: the memory gave it several ids. Pure. See B6.
#pragma once

#include <Eigen/Core>

#include "mapper/core/landmarks.h"

namespace vismem {

struct LandmarkMergeParams {
  double angle_rad = 0.06;
  double across_m = 0.05;  ///< distance across, at most; more when covariances allow ..
  double sigmas = 3.0;
  double most_across_m = 0.10;  ///< .. but never more
  double gap_m = 0.06;          ///< between the extents of pieces ..
  double open_gap_m = 0.60;     ///< .. whose ends no image saw: something stands before the edge ..
  double open_gap_share = 0.3;  ///< .. which is so much of both pieces' length at most ..
  std::vector<std::string> obstacles{"skirting", "*_foot"};  ///< .. and has one of these labels
  double end_m = 0.08;                                       ///< ends of pieces nearer than this are one end
};

/// Merges landmarks of one label and polarity that overlap, or touch, within 3 sigma and that no image showed
/// together: two edges beside each other stay two however near they are.
/// @return number of merges.
int mergeLandmarks(const DriveRecord& record, const LandmarkMergeParams& params, MapState& state);

}  // namespace vismem
