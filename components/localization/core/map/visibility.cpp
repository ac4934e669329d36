#include "localization/core/map/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kSpacing_m = 0.2;  // between points
/// A point this near behind an opaque segment counts as visible: walls do not occlude their own foot.
constexpr double kMargin_m = 0.3;
constexpr int kBearings = 256;  // of the depth buffer

/// Grows with the bearing from 0 to 4, without trigonometry.
double diamondAngle(const Eigen::Vector2d& p) {
  const double sum = std::abs(p.x()) + std::abs(p.y());
  if (sum == 0.0) return 0.0;
  const double t = p.y() / sum;
  if (p.x() < 0.0) return 2.0 - t;
  return t < 0.0 ? 4.0 + t : t;
}

/// The nearest occluding distance by bearing.
class DepthBuffer {
 public:
  DepthBuffer() { depth_.fill(1e9f); }

  /// Adds a piece that is short compared with its distance.
  void add(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& middle) {
    const int first = bin(from);
    int steps = bin(to) - first;
    if (steps > kBearings / 2) steps -= kBearings;
    if (steps < -kBearings / 2) steps += kBearings;
    const int step = steps < 0 ? -1 : 1;
    for (int i = 0; i != steps + step; i += step) {
      float& depth = depth_[static_cast<std::size_t>((first + i + kBearings) % kBearings)];
      depth = std::min(depth, static_cast<float>(middle.norm()));
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

bool matchesAny(const Label& label, std::span<const std::string> names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return name.starts_with('*') ? label.ends_with(std::string_view(name).substr(1)) : label == name;
  });
}

CameraView::CameraView(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera) {
  const Pose3 T_camera_robot = T_robot_camera.inverse();
  // Each border of the image is a plane through the camera; its intersection with the floor is a half plane.
  const auto border = [&](double x, double y, double z, double offset) {
    const Eigen::RowVector3d normal(x, y, z);
    return HalfPlane{(normal * T_camera_robot.linear().leftCols<2>()).transpose(),
                     normal * T_camera_robot.translation() + offset};
  };
  borders_ = {border(0.0, 0.0, 1.0, -kNearPlane_m), border(intrinsics.fx, 0.0, intrinsics.cx, 0.0),
              border(0.0, intrinsics.fy, intrinsics.cy, 0.0),
              border(-intrinsics.fx, 0.0, intrinsics.width - 1.0 - intrinsics.cx, 0.0),
              border(0.0, -intrinsics.fy, intrinsics.height - 1.0 - intrinsics.cy, 0.0)};
}

bool CameraView::shows(const Eigen::Vector2d& p_robot) const {
  return std::all_of(borders_.begin(), borders_.end(),
                     [&](const HalfPlane& border) { return border.at(p_robot) >= 0.0; });
}

Visibility::Visibility(const MapIndex& map, std::span<const std::string> opaque) {
  for (int label = 0; label < map.labelCount(); ++label) {
    const bool is_opaque = matchesAny(map.labelName(label), opaque);
    for (const Segment2& plan : map.floor(label)) {
      if (plan.length() > 0.0) lines_.push_back({plan, label, is_opaque});
    }
  }
}

void Visibility::around(const Pose2& T_world_robot, double range_m, std::vector<VisiblePoint>& out) const {
  out.clear();
  const Pose2 T_robot_world = inverse(T_world_robot);
  DepthBuffer depth;
  for (const Line& line : lines_) {
    if (distanceToSegment(T_world_robot.position(), line.plan) > range_m) continue;
    const Segment2 robot = transform(T_robot_world, line.plan);
    const int pieces = std::max(1, static_cast<int>(std::lround(line.plan.length() / kSpacing_m)));
    const Eigen::Vector2d step = (robot.b - robot.a) / pieces;
    for (int i = 0; i < pieces; ++i) {
      const Eigen::Vector2d middle = robot.a + (i + 0.5) * step;
      if (middle.norm() > range_m) continue;
      out.push_back({middle, robot.direction(), step.norm(), line.label});
      const Eigen::Vector2d begin = robot.a + i * step;
      if (line.opaque) depth.add(begin, begin + step, begin + 0.5 * step);
    }
  }
  std::erase_if(out, [&](const VisiblePoint& point) { return depth.hides(point.p_robot); });
}

}  // namespace vismem
