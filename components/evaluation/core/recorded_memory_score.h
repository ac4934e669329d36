/// @file Agreement of a recording's memory with the map, without a known truth: the map is aligned with the
/// memory by one rigid motion for each window of time. Pure. See E4.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/memory_score.h"

namespace vismem {

struct RecordedMemoryParams {
  StampUs window_us = 5'000'000;  ///< length of a window; one alignment each
  double range_m = 2.5;           ///< farther parts of the memory are left out
  double step_m = 0.05;           ///< between points on remembered edges
  double angle_rad = 0.35;        ///< largest angle between an element and its map edge
  double kernel_m = 0.10;         ///< of the alignment's Cauchy weight
  double lost_m = 1.0;            ///< distance of a point without a map edge of its direction
  /// Range of radii of the circles that are measured.
  double min_radius_m = 0.3;
  double max_radius_m = 1.0;
  /// Largest distance of an element from its map edge.
  double on_edge_m = 0.15;
  double least_cover = 0.5;    ///< share of a circle that elements must cover to measure its radius
  double curve_piece_m = 0.2;  ///< longest piece of a curve in the map
  double curve_gap_m = 0.01;   ///< largest gap between the sides of such pieces
};

/// The memory after one image, and the estimated pose from which the alignment starts.
struct RecordedMoment {
  std::shared_ptr<const MemorySnapshot> memory;  ///< not null
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera = Pose3::Identity();
  std::optional<Pose2> T_world_robot;
};

/// Aligns remembered edges with the map: robust least squares of the distances across the nearest map edges
/// of their directions, over a rigid motion of the plane.
/// @param odom remembered edges, in odom.
/// @param map edges, in world.
/// @param T_world_odom where the search starts.
/// @return T_world_odom.
Pose2 alignToMap(const std::vector<Segment2>& odom, const std::vector<Segment2>& map,
                 const Pose2& T_world_odom, const RecordedMemoryParams& params = {});

/// Appends the distances of the points on an edge (in world) to the nearest map edge of its direction [m].
void appendDistances(const Segment2& world, const std::vector<Segment2>& map,
                     const RecordedMemoryParams& params, std::vector<double>& distances_m);

struct RecordedMemoryScore {
  struct Spread {
    double median = 0.0;
    double least = 0.0;
    double most = 0.0;
  };
  struct Window {
    StampUs from_us = 0;
    Pose2 T_world_odom;
    std::optional<double> distance_m;  ///< median over the points of confirmed elements of all its moments
  };

  int moments = 0;
  int moments_without_pose = 0;  ///< in windows without any estimated pose; they are otherwise left out
  std::vector<Window> windows;
  /// Medians over all points of confirmed elements, and of all elements, within the range.
  std::optional<double> distance_m;
  std::optional<double> distance_with_unconfirmed_m;
  /// Radius of a round line's middle, fitted to all elements on it, over the moments in which they cover at
  /// least `least_cover` of it.
  std::optional<Spread> circle_radius_m;
  int moments_with_circle = 0;
  /// Radius of the circle primitive, over the moments that have one.
  std::optional<Spread> circle_shape_radius_m;
  int moments_with_circle_shape = 0;
  Spread elements_per_edge;         ///< over the moments: confirmed elements per map edge that has any
  Spread elements_per_edge_all;     ///< unconfirmed ones, too
  Spread confirmed;                 ///< elements in memory
  std::optional<MemoryScore> last;  ///< of the last moment, with the tolerance on_edge_m
  std::vector<RememberedEdge> last_memory;  ///< in world
  std::vector<TrueEdge> edges;              ///< of the map, with the parts that images showed
};

/// @param moments in order of their stamps. @param edges of the map, stripes expanded.
RecordedMemoryScore scoreRecordedMemory(const std::vector<RecordedMoment>& moments, const SegmentMap& edges,
                                        const RecordedMemoryParams& params = {});

}  // namespace vismem
