#include "simulator/core/renderer_narrow.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/geometry/projection.h"
#include "simulator/core/body_creases.h"

namespace vismem {
namespace {

constexpr std::size_t kMaxTriangles = 400;
/// A body is narrow if its second longest side is shorter ...
constexpr double kNarrow_m = 0.3;
/// ... or if it is as flat as paint: another body may then leave only a strip of it visible (a circle within
/// a circle).
constexpr double kPaint_m = 0.01;
constexpr double kStrip_m = 0.1;
/// Foreshortening of a floor strip at the flattest considered view.
constexpr double kFlatness = 15.0;
constexpr double kCreaseAngle_rad = 0.35;
constexpr double kStep_px = 0.5;

/// Side lengths of the box along the principal axes of the points, the shortest first.
Eigen::Vector3d sidesOf(const WorldBody& body) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& v : body.vertices) mean += v.cast<double>() / static_cast<double>(body.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& v : body.vertices) {
    const Eigen::Vector3d d = v.cast<double>() - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  Eigen::AlignedBox3d box;
  for (const auto& v : body.vertices) box.extend(axes.eigenvectors().transpose() * v.cast<double>());
  Eigen::Vector3d sides = box.sizes();
  std::sort(sides.data(), sides.data() + 3);
  return sides;
}

}  // namespace

void NarrowBodies::add(const WorldModel& model) {
  Model& added = models_.emplace_back();
  for (const WorldBody& body : model.bodies) {
    if (body.vertices.empty() || body.triangles.size() > kMaxTriangles) continue;
    const Eigen::Vector3d sides = sidesOf(body);
    double low = 1e9;
    double high = -1e9;
    for (const auto& v : body.vertices) {
      const double z = (model.pose.linear().row(2) * v.cast<double>()).value();
      low = std::min(low, z);
      high = std::max(high, z);
    }
    double width = sides[1];
    if (high - low < kPaint_m) width = std::min(width, kStrip_m);
    if (!(width < kNarrow_m)) continue;
    for (const Segment3& line : creasesOf(body, Pose3::Identity(), kCreaseAngle_rad)) {
      added.creases.push_back({line, width / kFlatness});
    }
  }
}

void NarrowBodies::mark(const CameraIntrinsics& k, const Pose3& T_world_camera, const Eigen::Vector2d& low,
                        const Eigen::Vector2d& high, const RenderScene& scene,
                        std::vector<char>& marks) const {
  marks.clear();
  const bool straight = k.k1 == 0.0 && k.k2 == 0.0 && k.k3 == 0.0 && k.p1 == 0.0 && k.p2 == 0.0;
  const double focal = std::max(k.fx, k.fy);
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const auto& creases = models_[m].creases;
    const int model = static_cast<int>(m);
    if (creases.empty() || !scene.isVisible(model)) continue;
    const Pose3 T_model_camera = scene.poseOf(model).inverse() * T_world_camera;
    const Eigen::Vector3d eye = T_model_camera.translation();
    for (const Crease& crease : creases) {
      const double farthest = std::max((crease.line.a - eye).norm(), (crease.line.b - eye).norm());
      if (farthest < crease.far_m * focal) continue;
      const auto seen = projectSegmentUnbounded(k, T_model_camera, crease.line);
      const auto line = seen ? clipToBox(*seen, low, high) : std::nullopt;
      if (!line) continue;
      if (marks.empty()) marks.assign(static_cast<std::size_t>(k.width) * k.height, 0);
      const Eigen::Vector2d d = line->b - line->a;
      const int steps = static_cast<int>(d.norm() / kStep_px) + 1;
      for (int i = 0; i <= steps; ++i) {
        Eigen::Vector2d px = line->a + (static_cast<double>(i) / steps) * d;
        if (!straight) px = distortPixel(k, px);
        const int u = static_cast<int>(std::lround(px.x()));
        const int v = static_cast<int>(std::lround(px.y()));
        if (u >= 0 && v >= 0 && u < k.width && v < k.height)
          marks[static_cast<std::size_t>(v) * k.width + u] = 1;
      }
    }
  }
}

}  // namespace vismem
