/// @file A map made from a drive against the true edges that the drive showed. Pure. See B6, E1.
#pragma once

#include <vector>

#include "evaluation/core/memory_score.h"

namespace vismem {

/// An edge of a map. Ends that are not closed are where the edge was last seen.
struct MappedEdge {
  Segment2 map;  ///< in the frame of the map [m]
  Label label;
  bool closed_a = false;
  bool closed_b = false;
};

struct MapScoreParams {
  MemoryScoreParams memory;
  double end_pair_m = 0.30;  ///< a closed end belongs to the nearest true end within this
  double piece_m = 5.0;      ///< size of the pieces that are aligned alone
  int least_edges = 4;       ///< of a piece
};

struct MapScore {
  Pose2 T_world_map;   ///< rigid alignment, without scale
  double scale = 1.0;  ///< by which the map is too large, from the distances of its matched ends
  MemoryScore edges;   ///< as in E1, after the alignment
  double ends_rms_m = 0.0;
  double ends_worst_m = 0.0;
  int ends = 0;                    ///< closed ends of edges with a true end near them
  double across_rms_m = 0.0;       ///< distance of edges from the lines of their true edges
  double worst_piece_rms_m = 0.0;  ///< largest ends_rms_m of a piece of the world, aligned as a whole
};

/// Rigid alignment that minimizes robust distances of the map's edges from true edges of their label.
/// @param start  within about 1 m and 10 degrees.
Pose2 alignToTruth(const std::vector<MappedEdge>& map, const std::vector<TrueEdge>& truth,
                   const Pose2& start);

/// Rigid motion of least squares that moves points a to points b (Umeyama 1991 without scale).
/// @return identity for fewer than two points.
Pose2 rigidFit(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b);

MapScore scoreMap(const std::vector<MappedEdge>& map, const std::vector<TrueEdge>& truth, const Pose2& start,
                  const MapScoreParams& params = {});

}  // namespace vismem
