/// @file What of the map can be seen from a place: points along its floor segments that no wall hides. Pure.
/// DESIGN 9 part 2, B4.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "localization/core/map_index.h"

namespace vismem {

/// A piece of a floor segment of the map, seen from some place.
struct VisiblePoint {
  Eigen::Vector2d p_robot = Eigen::Vector2d::Zero();  ///< its middle [m]
  double direction_robot = 0.0;                       ///< of its segment [rad]
  double length_m = 0.0;
  int label = 0;
  std::uint32_t segment = 0;  ///< pieces of one segment have the same number
};

/// True if the label is one of the names; a name that begins with '*' stands for every label that ends like
/// it.
bool isListed(const Label& label, std::span<const std::string> names);

/// Which points of the floor a camera shows, for quick repeated questions. *Pure* after construction.
class CameraView {
 public:
  CameraView(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera);
  bool shows(const Eigen::Vector2d& p_robot) const;

 private:
  Eigen::Matrix<double, 3, 2> columns_;  // of the rotation robot -> camera that floor points use
  Eigen::Vector3d offset_;
  double fx_, fy_, cx_, cy_, width_, height_;
};

/// *Pure* after construction; memory grows with the length of the map's segments.
class VisibleMap {
 public:
  /// @param opaque labels of what stands up and hides the floor behind it (see isListed).
  VisibleMap(const MapIndex& map, std::span<const std::string> opaque);

  /// The points within `range_m` of the robot, in all directions, that no opaque segment hides.
  /// @param obstacles further things that hide what is behind them, in the robot's frame [m].
  /// @param view if given, only what lies in the image. @param out is cleared first.
  void around(const Pose2& T_world_robot, double range_m, std::span<const Segment2> obstacles,
              const CameraView* view, std::vector<VisiblePoint>& out) const;

 private:
  struct Point {
    Eigen::Vector2d p_world;
    Eigen::Vector2d half;  // from the middle to an end
    double direction = 0.0;
    int label = 0;
    std::uint32_t segment = 0;
    bool opaque = false;
  };
  struct Range {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  std::vector<Point> points_;  // by cell
  std::unordered_map<std::uint64_t, Range> cells_;
};

}  // namespace vismem
