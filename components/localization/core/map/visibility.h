/// @file Visibility: the points of the map's floor segments that no opaque segment occludes. Pure.
/// See L12, B4.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
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
  std::uint32_t segment = 0;  ///< index; pieces of one segment share it
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
  /// False if nothing within `radius_m` of the point is in view.
  bool mayShow(const Eigen::Vector2d& p_robot, double radius_m) const;
  /// Clips a line to the view.
  /// @param start and @param way: the line's points are start + fraction * way.
  /// @param from and @param to fractions, narrowed to the visible part.
  /// @return false if no part is in view.
  bool clip(const Eigen::Vector2d& start, const Eigen::Vector2d& way, double& from, double& to) const;

 private:
  std::array<HalfPlane, 5> borders_;  // the image's four and the near plane
  std::array<double, 5> slopes_{};    // of them: change per metre
};

/// The map's floor segments in cells, with occlusion by a depth buffer over bearings. *Pure* after
/// construction. Memory grows with the number and the length of the segments; points are generated per query.
class Visibility {
 public:
  /// @param opaque labels of upright segments that occlude the floor behind them (see matchesAny).
  Visibility(const MapIndex& map, std::span<const std::string> opaque);

  /// The points within `range_m` of the robot, in all directions, that no opaque segment occludes.
  /// @param obstacles further occluding segments in the robot's frame [m].
  /// @param view null, or a view that limits the result.
  /// @param out is cleared first.
  void around(const Pose2& T_world_robot, double range_m, std::span<const Segment2> obstacles,
              const CameraView* view, std::vector<VisiblePoint>& out) const;

 private:
  struct alignas(64) Line {  // a segment, cut into pieces of one length
    Eigen::Vector2d a;
    Eigen::Vector2d way;  // to its end
    double direction = 0.0;
    int pieces = 1;
    int label = 0;
    std::uint32_t number = 0;
    bool opaque = false;
  };
  struct Run {  // pieces of one segment with their middles in one cell
    std::uint32_t line = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Row {  // of cells
    std::int32_t y = 0;
    std::uint32_t first = 0;  // its first of cells_
  };
  std::span<const Run> runsOf(std::size_t cell) const {
    return std::span(runs_).subspan(first_of_[cell], first_of_[cell + 1] - first_of_[cell]);
  }
  template <typename MayCount, typename Visit>
  void visitRuns(const Eigen::Vector2d& position, double range_m, MayCount may_count, Visit visit) const;

  std::vector<Line> lines_;
  std::vector<Run> runs_;                // by cell
  std::vector<Row> rows_;                // those with runs; one more at the end
  std::vector<std::int32_t> cells_;      // those with runs, row by row: their x
  std::vector<std::uint32_t> first_of_;  // of a cell's runs; one more at the end
};

}  // namespace vismem
