/// @file The chapter's two health functions. Pure. Implements L4, L5.
#pragma once

#include <memory>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/projection.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/likelihood/pixel_footprint.h"
#include "localization/core/map/map_index.h"
#include "localization/core/map/segment_tree.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/observation/sampling_grid.h"

namespace vismem {

/// Chapter mode.
struct HealthParams {
  /// L4 is the default: its points are what the camera sees now. L5 needs a memory without false elements,
  /// because one off-floor edge costs as much as a wrong pose.
  ObservationSource source = ObservationSource::kImage;
  bool use_field = true;         ///< false: exhaustive search over the map, the reference
  double memory_scale_m = 0.5;   ///< M of L5
  double image_scale_px = 50.0;  ///< M of L4 at 320 columns; scaled with the image's width
  double memory_range_m = 4.0;   ///< largest range of remembered segments (M5)
  double grid_top_px = 10.0;     ///< height of the sampling grid's cells at the top of a 240-row image
  double grid_bottom_px = 40.0;  ///< the same at its bottom
};

/// How the map must be indexed for this health.
MapIndex::Params chapterIndex(const HealthParams& params, const MapParams& map);

/// Buffer of the map lines of one label projected into one image.
class ProjectedLines {
 public:
  /// Keeps the lines of which any part is in view, clipped at the near plane only.
  void project(const std::vector<Segment3>& segments_world, const SegmentProjector& projector);
  bool isEmpty() const { return lines_.empty(); }
  /// Distance to the nearest line [px]. Must not be empty.
  double distance(const Eigen::Vector2d& px) const;

 private:
  std::vector<ProjectedLine> lines_;
};

/// L4: `H = 1 - mean(d_i) / M`, clamped to 0..1. d_i is the distance in the image to the nearest map line of
/// the label of which any part is in view. Lines are clipped at the near plane, not at the image border. A
/// label without a line in view counts the image's diagonal. Exhaustive over the map: the reference for
/// HealthObservation, which uses floor cells and trees.
/// @param points must not be empty; points of one label should be adjacent, for speed.
/// @param scale_px M for this image.
/// @param buffer of this function, kept between calls.
double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px, ProjectedLines& buffer);

/// A remembered segment in the robot's frame (L5).
struct RememberedLine {
  Segment2 robot;  ///< plan view [m]
  int label = 0;
};

/// L5: `H = 1 - mean((d_js + d_je) / 2) / M`, clamped to 0..1, distances in plan view (the memory lies on
/// the floor).
/// @param lines must not be empty.
/// @param scale_m M.
/// @param least a health below it may be returned as 0.
double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m, double least = 0.0);

/// One observation prepared for rating poses: the memory's lines, the image's points, or both. Segments
/// labelled unknown or with a label that the map lacks are left out. *Single-threaded* (owner: ChapterRaces).
class HealthObservation {
 public:
  HealthObservation(const MapIndex& map, const HealthParams& params) : map_(map), params_(params) {}

  void set(const MemoryUpdate& update);
  /// True: no lines and no points; healths stay unchanged (L4).
  bool isEmpty() const { return lines_.empty() && points_.empty(); }
  /// Number of lines and points, the amount of evidence of the reliability rule.
  std::size_t size() const { return lines_.size() + points_.size(); }
  /// The mean of the health functions that have lines or points.
  /// @param least a health below it is returned as 0, at less cost.
  double health(const Pose2& T_world_robot, double least = 0.0) const;

 private:
  struct Group {  // of points with one label
    int label = 0;
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// One level of the search: discs of the floor that contain all lines within a distance of the points.
  struct Floor {
    double within_px = 0.0;
    std::vector<FloorDisc> discs;       // by group
    std::vector<double> reach_squares;  // by point: lines outside the disc are further [px^2]
  };
  /// Points of a group for which a nearer line may exist.
  struct Open {
    std::vector<std::size_t> numbers;
    std::vector<Eigen::Vector2d> pixels;
    std::vector<double> squares;
  };
  class PlacedCamera;
  double imageScale() const;  // M of L4 for this image
  void prepareFloors();
  bool searchFloor(const Group& group, const FloorDisc& disc, PlacedCamera& place) const;
  bool searchNear(const Group& group, const TreeCamera& camera, double within_px) const;
  bool gatherOpen(const Group& group, std::span<const double> reach_squares) const;
  void storeOpen() const;
  double healthByIndex(const Pose2& T_world_robot, double least) const;

  const MapIndex& map_;
  HealthParams params_;
  std::vector<RememberedLine> lines_;
  std::vector<ImagePoint> points_;       ///< by label
  std::vector<Eigen::Vector2d> pixels_;  ///< of points_
  std::vector<Group> groups_;            ///< of points_
  std::vector<Floor> floors_;            ///< smallest first
  double diagonal_px_ = 0.0;
  mutable ProjectedLines projected_;
  mutable SegmentTree::Buffer tree_buffer_;
  mutable std::vector<double> squares_;  ///< by point: to the nearest line found [px^2]
  mutable std::vector<bool> in_view_;    ///< by group: any line
  mutable Open open_;
  CameraIntrinsics intrinsics_;
  Pose3 T_robot_camera_ = Pose3::Identity();
};

}  // namespace vismem
