/// @file Which of many segments of space is nearest in an image: a tree of boxes. Pure. SPEC L4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/projection.h"
#include "common/geometry/segment.h"

namespace vismem {

/// A line in the image, quick to measure.
class ProjectedLine {
 public:
  explicit ProjectedLine(const Segment2& px)
      : ax_(px.a.x()), ay_(px.a.y()), dx_(px.b.x() - px.a.x()), dy_(px.b.y() - px.a.y()) {
    const double square = dx_ * dx_ + dy_ * dy_;
    per_square_ = square > 0.0 ? 1.0 / square : 0.0;
  }
  /// To a pixel, squared [px^2].
  double square(const Eigen::Vector2d& px) const {
    const double rx = px.x() - ax_;
    const double ry = px.y() - ay_;
    const double fraction = std::min(std::max((rx * dx_ + ry * dy_) * per_square_, 0.0), 1.0);
    const double x = rx - fraction * dx_;
    const double y = ry - fraction * dy_;
    return x * x + y * y;
  }

 private:
  double ax_, ay_, dx_, dy_;  // begin and way [px]
  double per_square_;         // 1 / its length squared; 0 for a point
};

/// A camera at a place, as SegmentTree asks it.
class TreeCamera {
 public:
  TreeCamera(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

 private:
  friend class SegmentTree;
  CameraIntrinsics intrinsics_;
  Pose3 T_camera_world_;
  Eigen::Vector3d centre_;  // in the world
  Eigen::Matrix3d reach_;   // of a box along the camera's axes, by its half sides
  SegmentProjector projector_;
};

/// Segments in boxes within boxes: what is out of view, or further in the image from every pixel that is
/// asked about than what was found already, is not looked at. Answers are those of a search over all, bit for
/// bit. Immutable: *thread-safe*.
class SegmentTree {
 public:
  /// Room for a search, kept between calls.
  using Room = std::vector<std::uint32_t>;

  explicit SegmentTree(std::span<const Segment3> segments_world);

  /// Squared distances [px^2] to the nearest line of which any part is in view, clipped at the near plane
  /// only.
  /// @param squares as many as pixels; set here, to `most_square` where all lines are further.
  /// @return false if no line is in view; without meaning if `most_square` is finite.
  bool nearestSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px,
                      std::span<double> squares, Room& room,
                      double most_square = std::numeric_limits<double>::infinity()) const;
  /// The same where something is known already: lowers each of `squares` to which a line is nearer.
  /// @return false if no line is in view; without meaning unless all are infinite.
  bool lowerSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px, std::span<double> squares,
                    Room& room) const;

 private:
  struct alignas(64) Node {  // a box; its first child is the next node
    Eigen::Vector3d middle;
    Eigen::Vector3d half;
    std::uint32_t second = 0;  // child; of a leaf: its first segment
    std::uint32_t count = 0;   // of a leaf's segments; 0: has children
  };
  struct Box {  // in the image [px]
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  struct Search;
  static Box projectedBox(const Node& node, const Eigen::Vector3d& middle, const TreeCamera& camera);
  void append(std::span<Segment3> segments, std::size_t first);
  /// @param asked pixels that may be nearer to what is in the node than to what was found.
  bool visit(Search& search, std::uint32_t number, std::span<const std::uint32_t> asked) const;

  std::vector<Node> nodes_;
  std::vector<Segment3> segments_;
};

}  // namespace vismem
