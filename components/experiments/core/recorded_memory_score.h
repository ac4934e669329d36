/// @file How well the memory made from a recording agrees with the map of the place, without a known truth:
/// the map is put on the memory, one rigid motion for each few seconds. Pure. SPEC E4.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "experiments/core/memory_score.h"

namespace vismem {

struct RecordedMemoryParams {
  StampUs window_us = 5'000'000;  ///< one alignment for all moments of so long
  double range_m = 2.5;           ///< parts of the memory farther from the robot do not count
  double step_m = 0.05;           ///< between points on remembered edges
  double angle_rad = 0.35;        ///< map edges in other directions are not what an element shows
  double kernel_m = 0.10;         ///< of the alignment (Cauchy): points further off than this hardly count
  double lost_m = 1.0;            ///< a point with no map edge of its direction counts so much
  /// Circles of the memory of other radii are not looked at.
  double min_radius_m = 0.3;
  double max_radius_m = 1.0;
  /// An element is on a map edge when it lies so near; painted lines are drawn as curves up to this length.
  double on_edge_m = 0.15;
  double least_cover = 0.5;  ///< share of a circle that elements must cover to tell its radius
  double curve_piece_m = 0.2;
  double curve_gap_m = 0.01;  ///< the sides of such a line's pieces meet only nearly
};

/// The memory after one image, and where localization put the robot then: where the alignment begins.
struct RecordedMoment {
  std::shared_ptr<const MemorySnapshot> memory;  ///< not null
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera = Pose3::Identity();
  std::optional<Pose2> T_world_robot;
};

/// Puts points of edges on the nearest map edges of their directions: robust least squares of the distances
/// across those edges, over a motion of the plane.
/// @param odom remembered edges, all at once. @param map edges in world. @return T_world_odom.
Pose2 alignToMap(const std::vector<Segment2>& odom, const std::vector<Segment2>& map,
                 const Pose2& T_world_odom, const RecordedMemoryParams& params = {});

/// Of the points on an edge (in world): to the nearest map edge of its direction [m].
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
  int moments_without_pose =
      0;  ///< in windows for which localization never had one; they count in nothing else
  std::vector<Window> windows;
  /// Median over all points of confirmed elements within the range, and over those of all elements.
  std::optional<double> distance_m;
  std::optional<double> distance_with_unconfirmed_m;
  /// Of the round map edges' middle line, fitted to the elements on them (unconfirmed ones, too), over the
  /// moments in which they cover at least `least_cover` of it.
  std::optional<Spread> circle_radius_m;
  int moments_with_circle = 0;
  /// Of the shape in memory, over the moments that have one.
  std::optional<Spread> circle_shape_radius_m;
  int moments_with_circle_shape = 0;
  Spread elements_per_edge;         ///< over the moments: confirmed elements per map edge that has any
  Spread elements_per_edge_all;     ///< unconfirmed ones, too
  Spread confirmed;                 ///< elements in memory
  std::optional<MemoryScore> last;  ///< of the last moment, loosely: what lies on the map within on_edge_m
  std::vector<RememberedEdge> last_memory;  ///< in world
  std::vector<TrueEdge> edges;              ///< the map, and what the images showed of it
};

/// @param moments in order of their stamps. @param edges of the map, stripes expanded.
RecordedMemoryScore scoreRecordedMemory(const std::vector<RecordedMoment>& moments, const SegmentMap& edges,
                                        const RecordedMemoryParams& params = {});

}  // namespace vismem
