/// @file Nearest 3-D segment in an image: a tree of bounding boxes. Pure. See L4.
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

/// A line in the image, prepared for distances.
class ProjectedLine {
 public:
  explicit ProjectedLine(const Segment2& px)
      : ax_(px.a.x()), ay_(px.a.y()), dx_(px.b.x() - px.a.x()), dy_(px.b.y() - px.a.y()) {
    const double square = dx_ * dx_ + dy_ * dy_;
    per_square_ = square > 0.0 ? 1.0 / square : 0.0;
  }
  /// Squared distance to a pixel [px^2].
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

/// A camera at a pose, prepared for SegmentTree.
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

/// Segments in nested boxes. Boxes out of view, or further from every query pixel than the nearest line so
/// far, are skipped. Results equal those of exhaustive search bit for bit. Immutable: *thread-safe*.
class SegmentTree {
 public:
  /// Buffer of a search, kept between calls.
  using Buffer = std::vector<std::uint32_t>;

  explicit SegmentTree(std::span<const Segment3> segments_world);

  /// Squared distances [px^2] to the nearest line of which any part is in view, clipped at the near plane
  /// only.
  /// @param squares result, one per pixel; `most_square` where all lines are further.
  /// @return false if no line is in view; undefined if `most_square` is finite.
  bool nearestSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px,
                      std::span<double> squares, Buffer& buffer,
                      double most_square = std::numeric_limits<double>::infinity()) const;
  /// The same from known upper bounds: lowers each of `squares` with a nearer line.
  /// @return false if no line is in view; undefined unless all are infinite.
  bool lowerSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px, std::span<double> squares,
                    Buffer& buffer) const;

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
  /// @param asked pixels that may be nearer to a line in the node than to the nearest one so far.
  bool visit(Search& search, std::uint32_t number, std::span<const std::uint32_t> asked) const;

  std::vector<Node> nodes_;
  std::vector<Segment3> segments_;
};

}  // namespace vismem
