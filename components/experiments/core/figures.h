/// @file The three pictures of a run: values in, picture out (CV_8UC3 in the order R, G, B). Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "experiments/core/metrics.h"
#include "experiments/core/trajectory.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// --- seen from above -----------------------------------------------------------------------------

struct LabelledSegment {
  Segment3 world;  ///< [m]
  Label label;
  StampUs unseen_us = 0;  ///< time since it was last seen
};

/// What the camera sees of the floor: a sector from the robot.
struct ViewCone {
  double heading_rad = 0.0;  ///< of the optical axis in world
  double opening_rad = 0.0;  ///< the horizontal field of view
  double range_m = 2.0;
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
  std::optional<Pose2> robot;  ///< where localization puts it at the end
  std::optional<Pose2> true_robot;
  std::optional<ViewCone> view;  ///< from `robot`
};

/// How world and picture meet: for tests, and for whoever draws on top.
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

/// The plot shows the map, and what lies up to a metre around it; without a map, all that is drawn.
TopViewFrame topViewFrame(const TopView& view);
cv::Mat drawTopView(const TopView& view);

/// Segments of a memory carried into world, each by where odom was believed to lie when it was last seen.
/// The memory lives in odom, whose drift since then would turn and shift what was seen early.
/// @param T_world_odom over time; the entry nearest in time is taken, because between two of them the belief
///                     may have jumped. Without any, nothing can be placed.
std::vector<LabelledSegment> carriedMemory(const MemorySnapshot& memory, const Trajectory& T_world_odom);

/// --- error over time -----------------------------------------------------------------------------

struct ErrorFigure {
  std::string title;
  LocalizationScore score;
  ScoreParams limits;  ///< drawn as dashed lines
};

/// Two plots over the seconds since the start, on logarithmic scales: position 1 cm .. 30 m and heading
/// 0.1 .. 180 degrees (values outside are put on the border). Images without a pose are marked at the top.
cv::Mat drawErrors(const ErrorFigure& figure);

/// Where a value stands in the picture of drawErrors: for tests.
/// @param seconds since the start. @param end_s the last stamp's.
Eigen::Vector2d positionErrorPx(double seconds, double end_s, double error_m);
Eigen::Vector2d headingErrorPx(double seconds, double end_s, double error_rad);

/// --- the last image ------------------------------------------------------------------------------

struct ImageFigure {
  std::string title;
  cv::Mat image;           ///< as the camera gave it: CV_8UC3 (R, G, B) or CV_8UC1
  ImageAnalysis analysis;  ///< of that image
  /// With a pose at the image's stamp the map is projected into a second picture beside the first.
  std::optional<Pose2> T_world_robot;
  std::vector<MapSegment> map_edges;  ///< stripes expanded
  double map_range_m = 6.0;
};

/// Left what was observed, predicted and matched; right the map projected with the pose.
cv::Mat drawLastImage(const ImageFigure& figure);

}  // namespace vismem
