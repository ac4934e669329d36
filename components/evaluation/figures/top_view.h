/// @file The top view of a run: map, paths, memory and races. Values in, picture out (CV_8UC3, R G B). Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/trajectory.h"
#include "evaluation/figures/view_cone.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

struct LabelledSegment {
  Segment3 world;  ///< [m]
  Label label;
  StampUs unseen_us = 0;  ///< time since it was last seen
  bool confirmed = true;  ///< false: it may be off the floor, and be elsewhere
};

struct TopView {
  std::string title;
  std::string subtitle;  ///< empty: no line for it
  SegmentMap map;        ///< stripes are drawn with their width
  Trajectory truth;      ///< all in world; empty: not known
  Trajectory odometry;
  Trajectory estimate;
  /// The estimate is drawn faint before this stamp; empty: never settled, or not known.
  std::optional<StampUs> settled_us;
  std::vector<LabelledSegment> memory;
  std::vector<RaceReport> races;
  std::optional<Pose2> robot;  ///< the estimated pose at the end
  std::optional<Pose2> true_robot;
  std::optional<ViewCone> view;  ///< from `robot`
};

/// The map from world to picture coordinates: for tests and for further drawing.
struct TopViewFrame {
  double px_per_m = 1.0;
  Eigen::Vector2d low_world = Eigen::Vector2d::Zero();  ///< at the plot's lower left corner [m]
  Eigen::Vector2d low_px = Eigen::Vector2d::Zero();     ///< the plot's upper left corner
  Eigen::Vector2d high_px = Eigen::Vector2d::Zero();    ///< the plot's lower right corner

  Eigen::Vector2d toPx(const Eigen::Vector2d& world) const {
    return {low_px.x() + (world.x() - low_world.x()) * px_per_m,
            high_px.y() - (world.y() - low_world.y()) * px_per_m};
  }
};

/// The plot's frame: the map and up to a metre around it; without a map, everything that is drawn.
TopViewFrame topViewFrame(const TopView& view);
cv::Mat drawTopView(const TopView& view);

/// Segments of a memory in world. The memory moves all its elements with the odometry drift that it
/// estimates, so one transform places all of them, whenever they were last seen.
/// @param T_world_odom of the pose estimate at the memory's stamp.
std::vector<LabelledSegment> memoryInWorld(const MemorySnapshot& memory, const Pose2& T_world_odom);

}  // namespace vismem
