/// @file Visibility: the points of the map's floor segments that no opaque segment occludes. Pure.
/// See B4.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "localization/core/map/map_index.h"

namespace vismem {

/// A piece of a floor segment of the map, in the frame of a robot.
struct VisiblePoint {
  Eigen::Vector2d p_robot = Eigen::Vector2d::Zero();  ///< its middle [m]
  double direction_robot = 0.0;                       ///< of its segment [rad]
  double length_m = 0.0;
  int label = 0;
};

/// True if the label matches one of the names. A name that begins with '*' matches every label with that
/// ending.
bool matchesAny(const Label& label, std::span<const std::string> names);

/// The points of a plane with normal . p + offset >= 0.
struct HalfPlane {
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  double offset = 0.0;

  double at(const Eigen::Vector2d& p) const { return normal.dot(p) + offset; }
};

/// The part of the floor in a camera's view, prepared for repeated queries. *Pure* after construction.
class CameraView {
 public:
  CameraView(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera);
  bool shows(const Eigen::Vector2d& p_robot) const;

 private:
  std::array<HalfPlane, 5> borders_;  // the image's four and the near plane
};

/// The map's floor segments, cut into pieces, with occlusion by a depth buffer over bearings. A query goes
/// through all segments. *Pure* after construction.
class Visibility {
 public:
  /// @param opaque labels of upright segments that occlude the floor behind them (see matchesAny).
  Visibility(const MapIndex& map, std::span<const std::string> opaque);

  /// The points within `range_m` of the robot, in all directions, that no opaque segment occludes.
  /// @param out is cleared first.
  void around(const Pose2& T_world_robot, double range_m, std::vector<VisiblePoint>& out) const;

 private:
  struct Line {
    Segment2 plan;
    int label = 0;
    bool opaque = false;
  };
  std::vector<Line> lines_;
};

}  // namespace vismem
