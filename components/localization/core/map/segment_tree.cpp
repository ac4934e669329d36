#include "localization/core/map/segment_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>

namespace vismem {
namespace {

constexpr std::size_t kLeaf = 6;    // segments
constexpr std::size_t kList = 40;   // so few are faster without a tree
constexpr double kRounding = 1e-3;  // tolerance of a box at the view's borders [px at 1 m]

}  // namespace

TreeCamera::TreeCamera(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera)
    : intrinsics_(intrinsics),
      T_camera_world_(T_world_camera.inverse(Eigen::Isometry)),
      centre_(T_world_camera.translation()),
      reach_(T_camera_world_.linear().cwiseAbs()),
      projector_(intrinsics, T_world_camera) {}

SegmentTree::SegmentTree(std::span<const Segment3> segments_world)
    : segments_(segments_world.begin(), segments_world.end()) {
  if (!segments_.empty()) append(segments_, 0);
}

/// Adds a box of segments to the tree.
/// @param first their index in segments_.
void SegmentTree::append(std::span<Segment3> segments, std::size_t first) {
  Eigen::Vector3d low = segments.front().a;
  Eigen::Vector3d high = low;
  for (const Segment3& segment : segments) {
    low = low.cwiseMin(segment.a).cwiseMin(segment.b);
    high = high.cwiseMax(segment.a).cwiseMax(segment.b);
  }
  const std::size_t number = nodes_.size();
  nodes_.push_back({0.5 * (low + high), 0.5 * (high - low), static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(segments.size())});
  if (segments.size() <= kLeaf || segments_.size() <= kList) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = segments.size() / 2;
  std::nth_element(
      segments.begin(), segments.begin() + static_cast<std::ptrdiff_t>(half), segments.end(),
      [axis](const Segment3& s, const Segment3& t) { return s.a[axis] + s.b[axis] < t.a[axis] + t.b[axis]; });
  nodes_[number].count = 0;
  append(segments.first(half), first);
  nodes_[number].second = static_cast<std::uint32_t>(nodes_.size());
  append(segments.subspan(half), first + half);
}

struct SegmentTree::Search {
  const TreeCamera& camera;
  std::span<const Eigen::Vector2d> px;
  std::span<double> squares;
  Buffer& buffer;
};

bool SegmentTree::nearestSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px,
                                 std::span<double> squares, Buffer& buffer, double most_square) const {
  std::fill_n(squares.begin(), px.size(), most_square);
  return lowerSquares(camera, px, squares, buffer);
}

bool SegmentTree::lowerSquares(const TreeCamera& camera, std::span<const Eigen::Vector2d> px,
                               std::span<double> squares, Buffer& buffer) const {
  if (nodes_.empty()) return false;
  constexpr std::size_t kDeepest = 34;  // depth of a tree of 2^32 segments and more
  buffer.resize(std::max(buffer.size(), px.size() * kDeepest));
  std::iota(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(px.size()), 0u);
  Search search{camera, px, squares, buffer};
  return visit(search, 0, std::span(buffer).first(px.size()));
}

/// Bounding box of the node's corners in the image. All corners lie beyond the near plane.
/// @param middle in the camera's frame.
SegmentTree::Box SegmentTree::projectedBox(const Node& node, const Eigen::Vector3d& middle,
                                           const TreeCamera& camera) {
  const auto& T = camera.T_camera_world_.matrix();
  const CameraIntrinsics& image = camera.intrinsics_;
  const Eigen::Vector3d x = T.col(0).head<3>() * node.half.x();
  const Eigen::Vector3d y = T.col(1).head<3>() * node.half.y();
  const Eigen::Vector3d z = T.col(2).head<3>() * node.half.z();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  const auto add = [&](const Eigen::Vector3d& corner) {
    const double per_depth = 1.0 / corner.z();
    const Eigen::Vector2d px(corner.x() * per_depth, corner.y() * per_depth);
    low = low.cwiseMin(px);
    high = high.cwiseMax(px);
  };
  const auto addFace = [&](const Eigen::Vector3d& centre) {
    add(centre - x - y);
    add(centre - x + y);
    add(centre + x - y);
    add(centre + x + y);
  };
  addFace(middle - z);
  if (node.half.z() > 0.0) addFace(middle + z);
  const Eigen::Vector2d focal(image.fx, image.fy);
  const Eigen::Vector2d centre(image.cx, image.cy);
  const Eigen::Vector2d rounding = Eigen::Vector2d::Constant(kRounding);
  return {centre + focal.cwiseProduct(low) - rounding, centre + focal.cwiseProduct(high) + rounding};
}

bool SegmentTree::visit(Search& search, std::uint32_t number, std::span<const std::uint32_t> asked) const {
  const Node& node = nodes_[number];
  const TreeCamera& camera = search.camera;
  const CameraIntrinsics& image = camera.intrinsics_;
  const Eigen::Matrix4d& T = camera.T_camera_world_.matrix();
  const Eigen::Vector3d middle = T.topLeftCorner<3, 3>() * node.middle + T.topRightCorner<3, 1>();
  const Eigen::Vector3d half = camera.reach_ * node.half;
  const double near = middle.z() - half.z();
  const double far = middle.z() + half.z();
  if (far < kNearPlane_m - kRounding) return false;
  std::span<const std::uint32_t> left = asked;
  if (near > kNearPlane_m) {
    const Box box = projectedBox(node, middle, camera);
    if (box.to.x() < -0.5 || box.from.x() > image.width - 0.5 || box.to.y() < -0.5 ||
        box.from.y() > image.height - 0.5) {
      return false;
    }
    const std::span room(search.buffer.data() + (asked.data() - search.buffer.data()) + asked.size(),
                         asked.size());
    std::size_t count = 0;
    for (const std::uint32_t i : asked) {
      const Eigen::Vector2d& px = search.px[i];
      const double x = std::max(std::max(box.from.x() - px.x(), px.x() - box.to.x()), 0.0);
      const double y = std::max(std::max(box.from.y() - px.y(), px.y() - box.to.y()), 0.0);
      room[count] = i;
      count += x * x + y * y < search.squares[i] ? 1 : 0;
    }
    if (count == 0) return false;
    left = room.first(count);
  } else {
    // Out of view if all corners beyond the near plane lie outside one border.
    const auto most = [far](double per_depth) { return std::max(per_depth * kNearPlane_m, per_depth * far); };
    if (image.fx * (middle.x() + half.x()) + most(image.cx + 0.5) < -kRounding ||
        image.fx * (half.x() - middle.x()) + most(image.width - 0.5 - image.cx) < -kRounding ||
        image.fy * (middle.y() + half.y()) + most(image.cy + 0.5) < -kRounding ||
        image.fy * (half.y() - middle.y()) + most(image.height - 0.5 - image.cy) < -kRounding) {
      return false;
    }
  }
  bool is_in_view = false;
  if (node.count > 0) {
    for (const Segment3& segment : std::span(segments_).subspan(node.second, node.count)) {
      const auto px = camera.projector_.unbounded(segment);
      if (!px || !camera.projector_.isInImage(*px)) continue;
      is_in_view = true;
      const ProjectedLine line(*px);
      for (const std::uint32_t i : left) {
        search.squares[i] = std::min(search.squares[i], line.square(search.px[i]));
      }
    }
    return is_in_view;
  }
  // The nearer child first: its lines bound the search in the other one.
  const auto distance = [&](std::uint32_t child) {
    return (nodes_[child].middle - camera.centre_).squaredNorm();
  };
  std::array<std::uint32_t, 2> children{number + 1, node.second};
  if (distance(children[1]) < distance(children[0])) std::swap(children[0], children[1]);
  for (const std::uint32_t child : children) is_in_view = visit(search, child, left) || is_in_view;
  return is_in_view;
}

}  // namespace vismem
