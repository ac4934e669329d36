#include "localization/core/visible_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismem {
namespace {

constexpr double kSpacing_m = 0.2;  // between points
constexpr double kCell_m = 2.0;     // of the index
/// Nearer than this to what hides it a point counts as seen: walls do not hide their own foot.
constexpr double kMargin_m = 0.3;
constexpr int kBearings = 256;  // of the depth buffer

std::uint64_t cellKey(std::int32_t x, std::int32_t y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) | static_cast<std::uint32_t>(y);
}

std::int32_t cellOf(double value) {
  return static_cast<std::int32_t>(std::floor(value / kCell_m));
}

/// Grows with the bearing from 0 to 4, without trigonometry.
double diamondAngle(const Eigen::Vector2d& p) {
  const double sum = std::abs(p.x()) + std::abs(p.y());
  if (sum == 0.0) return 0.0;
  const double t = p.y() / sum;
  if (p.x() < 0.0) return 2.0 - t;
  return t < 0.0 ? 4.0 + t : t;
}

/// The nearest distance by bearing at which something hides what is behind.
class DepthBuffer {
 public:
  DepthBuffer() { depth_.fill(1e9f); }

  /// A thing from `a` to `b`, short against its distance.
  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const auto distance = static_cast<float>(0.5 * (a + b).norm());
    const int from = bin(a);
    int steps = bin(b) - from;
    if (steps > kBearings / 2) steps -= kBearings;
    if (steps < -kBearings / 2) steps += kBearings;
    const int step = steps < 0 ? -1 : 1;
    for (int i = 0; i != steps + step; i += step) {
      float& depth = depth_[static_cast<std::size_t>((from + i + kBearings) % kBearings)];
      depth = std::min(depth, distance);
    }
  }
  bool hides(const Eigen::Vector2d& p) const {
    return p.norm() > static_cast<double>(depth_[static_cast<std::size_t>(bin(p))]) + kMargin_m;
  }

 private:
  static int bin(const Eigen::Vector2d& p) {
    return std::min(kBearings - 1, static_cast<int>(diamondAngle(p) * (kBearings / 4.0)));
  }
  std::array<float, kBearings> depth_;
};

}  // namespace

bool isListed(const Label& label, std::span<const std::string> names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return name.starts_with('*') ? label.ends_with(std::string_view(name).substr(1)) : label == name;
  });
}

CameraView::CameraView(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera)
    : fx_(intrinsics.fx),
      fy_(intrinsics.fy),
      cx_(intrinsics.cx),
      cy_(intrinsics.cy),
      width_(intrinsics.width),
      height_(intrinsics.height) {
  const Pose3 T_camera_robot = T_robot_camera.inverse();
  columns_ = T_camera_robot.linear().leftCols<2>();
  offset_ = T_camera_robot.translation();
}

bool CameraView::shows(const Eigen::Vector2d& p_robot) const {
  const Eigen::Vector3d p = columns_ * p_robot + offset_;
  if (p.z() < 0.05) return false;
  const double u = fx_ * p.x() + cx_ * p.z();
  const double v = fy_ * p.y() + cy_ * p.z();
  return u >= 0.0 && v >= 0.0 && u <= (width_ - 1.0) * p.z() && v <= (height_ - 1.0) * p.z();
}

VisibleMap::VisibleMap(const MapIndex& map, std::span<const std::string> opaque) {
  std::vector<std::pair<std::uint64_t, Point>> points;
  std::uint32_t number = 0;
  for (int label = 0; label < map.labelCount(); ++label) {
    const bool is_opaque = isListed(map.labelName(label), opaque);
    for (const Segment2& segment : map.floor(label)) {
      ++number;
      const double length = segment.length();
      if (length <= 0.0) continue;
      const int count = std::max(1, static_cast<int>(std::lround(length / kSpacing_m)));
      for (int i = 0; i < count; ++i) {
        const Eigen::Vector2d p = segment.a + (i + 0.5) / count * (segment.b - segment.a);
        points.push_back(
            {cellKey(cellOf(p.x()), cellOf(p.y())),
             {p, 0.5 / count * (segment.b - segment.a), segment.direction(), label, number, is_opaque}});
      }
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  points_.reserve(points.size());
  for (const auto& [key, point] : points) {
    Range& range =
        cells_.try_emplace(key, Range{static_cast<std::uint32_t>(points_.size()), 0}).first->second;
    ++range.count;
    points_.push_back(point);
  }
}

void VisibleMap::around(const Pose2& T_world_robot, double range_m, std::span<const Segment2> obstacles,
                        const CameraView* view, std::vector<VisiblePoint>& out) const {
  out.clear();
  DepthBuffer depth;
  const double c = std::cos(T_world_robot.theta);
  const double s = std::sin(T_world_robot.theta);
  const auto turn = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(c * v.x() + s * v.y(), -s * v.x() + c * v.y());
  };
  const Eigen::Vector2d position = T_world_robot.position();
  for (std::int32_t y = cellOf(position.y() - range_m); y <= cellOf(position.y() + range_m); ++y) {
    for (std::int32_t x = cellOf(position.x() - range_m); x <= cellOf(position.x() + range_m); ++x) {
      const auto found = cells_.find(cellKey(x, y));
      if (found == cells_.end()) continue;
      for (std::uint32_t i = 0; i < found->second.count; ++i) {
        const Point& point = points_[found->second.first + i];
        const Eigen::Vector2d p_robot = turn(point.p_world - position);
        if (p_robot.squaredNorm() > range_m * range_m) continue;
        if (point.opaque) {
          const Eigen::Vector2d half = turn(point.half);
          depth.add(p_robot - half, p_robot + half);
        }
        if (view && !view->shows(p_robot)) continue;
        out.push_back({p_robot, point.direction - T_world_robot.theta, 2.0 * point.half.norm(), point.label,
                       point.segment});
      }
    }
  }
  for (const Segment2& obstacle : obstacles) {
    const int pieces = std::max(1, static_cast<int>(obstacle.length() / kSpacing_m));
    const Eigen::Vector2d step = (obstacle.b - obstacle.a) / pieces;
    for (int i = 0; i < pieces; ++i) depth.add(obstacle.a + i * step, obstacle.a + (i + 1) * step);
  }
  std::erase_if(out, [&](const VisiblePoint& point) { return depth.hides(point.p_robot); });
}

}  // namespace vismem
