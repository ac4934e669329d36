/// @file Landmarks that are one edge: the memory gave it several ids. Pure. See B6.
#pragma once

#include <Eigen/Core>
#include <optional>

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

struct EdgesTwiceParams {
  double angle_rad = 0.15;
  double least_across_m = 0.05;  ///< nearer ones mislead nobody
  double most_across_m = 0.50;   ///< further ones may be two edges
  double least_m = 0.30;         ///< of the part beside the other
  double apart_m = 6.0;          ///< way between all views of one and of the other
  int least_edges = 3;
};

/// Edges that stand twice in a solved map: two visits of a place that were not joined.
struct EdgesTwice {
  int edges = 0;
  double length_m = 0.0;                            ///< of their parts beside each other
  double across_m = 0.0;                            ///< largest distance ..
  Eigen::Vector2d world = Eigen::Vector2d::Zero();  ///< .. and where that is [m]
};

/// Edges of one label and polarity beside each other that no two images of one visit showed.
/// @return empty if there are too few to be sure.
std::optional<EdgesTwice> edgesTwice(const DriveRecord& record, const EdgesTwiceParams& params,
                                     const MapState& state);

}  // namespace vismem
