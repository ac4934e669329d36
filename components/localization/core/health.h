/// @file The chapter's two health functions and the sampling of image segments. Pure. SPEC L3, L4, L5.
#pragma once

#include <memory>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/projection.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/pixel_footprint.h"
#include "localization/core/segment_tree.h"

namespace vismem {

/// How the map must be indexed for this mode's health.
MapIndex::Params chapterIndex(const LocalizerParams& params);

/// A point of an observed image segment (L3).
struct ImagePoint {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  ///< ideal pixel
  int label = 0;                                 ///< number in the map index
};

/// The sampling grid of L3: rows whose height grows from the top of the image to its bottom, each cut into
/// cells as wide as it is high. Sizes are those of a 320x240 image and scale with the image.
class SamplingGrid {
 public:
  SamplingGrid(int width, int height, double top_px, double bottom_px);

  /// Where the segment crosses lines of the grid, from a to b.
  std::vector<Eigen::Vector2d> crossings(const Segment2& px) const;
  /// Upper borders of the rows and the image's lower border [px].
  const std::vector<double>& rowBorders() const { return row_borders_; }

 private:
  double width_;
  std::vector<double> row_borders_;
};

/// Room for the lines of one label in one image, kept between calls.
class ProjectedLines {
 public:
  /// Those of which any part is in view, clipped at the near plane only.
  void project(const std::vector<Segment3>& segments_world, const SegmentProjector& projector);
  bool isEmpty() const { return lines_.empty(); }
  /// To the nearest of them. Not empty.
  double distance(const Eigen::Vector2d& px) const;

 private:
  std::vector<ProjectedLine> lines_;
};

/// L4: `H = 1 - mean(d_i) / M`, clamped to 0..1.
/// d_i: distance in the image to the nearest map line of the label of which any part is in view; lines are
/// clipped at the near plane, not at the border; a label without a line in view counts the image's diagonal.
/// Over all segments of the map: the reference for HealthObservation, which asks cells of the floor and trees
/// if the map has them.
/// @param scale_px M for this image. @param points must not be empty; quickest with those of a label
/// together.
double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px, ProjectedLines& room);

/// A remembered segment in the robot's frame (L5).
struct RememberedLine {
  Segment2 robot;  ///< plan view [m]
  int label = 0;
};

/// L5: `H = 1 - mean((d_js + d_je) / 2) / M`, clamped to 0..1, distances in plan view (the memory lies on
/// the floor). @param lines must not be empty. @param least what is certainly under it may be told as 0.
double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m, double least = 0.0);

/// One observation, ready to rate places with: the memory's lines, the image's points, or both. Segments
/// labelled unknown or with a label that the map does not have say nothing about the place and are left out.
/// *Single-threaded* (owner: the strategy).
class HealthObservation {
 public:
  HealthObservation(const MapIndex& map, const HealthParams& params) : map_(map), params_(params) {}

  void set(const MemoryUpdate& update);
  /// False: nothing to rate with; healths stay as they are (L4).
  bool isEmpty() const { return lines_.empty() && points_.empty(); }
  /// Lines and points count alike: what the reliability rule calls the amount of evidence.
  std::size_t size() const { return lines_.size() + points_.size(); }
  /// The mean of the health functions that have something to rate with.
  /// @param least what is certainly under it may be told as 0: it costs less.
  double health(const Pose2& T_world_robot, double least = 0.0) const;

 private:
  struct Group {  // of points with one label
    int label = 0;
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// What a search of so much floor tells.
  struct Floor {
    double within_px = 0.0;             // all lines so near to points are there, but for some of the points
    std::vector<FloorDisc> discs;       // of the groups
    std::vector<double> reach_squares;  // of the points: lines elsewhere are further [px^2]
  };
  /// Points of a group of which a nearer line may be found, side by side.
  struct Open {
    std::vector<std::size_t> numbers;
    std::vector<Eigen::Vector2d> pixels;
    std::vector<double> squares;
  };
  class PlacedCamera;
  double imageScale() const;  // of L4, for this image
  void prepareFloors();
  bool searchFloor(const Group& group, const FloorDisc& disc, PlacedCamera& place) const;
  bool searchNear(const Group& group, const TreeCamera& camera, double within_px) const;
  bool gatherOpen(const Group& group, std::span<const double> reach_squares) const;
  void putBack() const;
  double healthByIndex(const Pose2& T_world_robot, double least) const;

  const MapIndex& map_;
  HealthParams params_;
  std::vector<RememberedLine> lines_;
  std::vector<ImagePoint> points_;       ///< by label
  std::vector<Eigen::Vector2d> pixels_;  ///< of points_
  std::vector<Group> groups_;            ///< of points_
  std::vector<Floor> floors_;            ///< the smallest first
  double diagonal_px_ = 0.0;
  mutable ProjectedLines room_;
  mutable SegmentTree::Room tree_room_;
  mutable std::vector<double> squares_;  ///< of points_, to the nearest line found [px^2]
  mutable std::vector<bool> in_view_;    ///< of groups_: a line
  mutable Open open_;
  CameraIntrinsics intrinsics_;
  Pose3 T_robot_camera_ = Pose3::Identity();
};

}  // namespace vismem
