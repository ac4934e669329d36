#include "common/geometry/projection.h"

#include <cmath>

namespace vismem {

/// Written out for speed: the health computes thousands of points per iteration.
Eigen::Vector3d SegmentProjector::toCamera(const Eigen::Vector3d& p) const {
  const auto& m = T_camera_world_.matrix();
  return {m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2) * p.z() + m(0, 3),
          m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2) * p.z() + m(1, 3),
          m(2, 0) * p.x() + m(2, 1) * p.y() + m(2, 2) * p.z() + m(2, 3)};
}

std::optional<Segment2> SegmentProjector::unbounded(const Segment3& segment_world) const {
  Eigen::Vector3d a = toCamera(segment_world.a);
  Eigen::Vector3d b = toCamera(segment_world.b);
  if (a.z() < kNearPlane_m && b.z() < kNearPlane_m) return std::nullopt;
  // Cut the end that lies before the near plane.
  if (a.z() < kNearPlane_m) {
    a += (kNearPlane_m - a.z()) / (b.z() - a.z()) * (b - a);
  } else if (b.z() < kNearPlane_m) {
    b += (kNearPlane_m - b.z()) / (a.z() - b.z()) * (a - b);
  }
  return Segment2{*projectToIdeal(intrinsics_, a), *projectToIdeal(intrinsics_, b)};
}

std::optional<Segment2> SegmentProjector::inImage(const Segment2& unbounded) const {
  return clipToBox(unbounded, {-0.5, -0.5}, {intrinsics_.width - 0.5, intrinsics_.height - 0.5});
}

bool SegmentProjector::isInImage(const Segment2& unbounded) const {
  const double right = intrinsics_.width - 0.5;
  const double bottom = intrinsics_.height - 0.5;
  const auto isInside = [&](const Eigen::Vector2d& px) {
    return px.x() >= -0.5 && px.x() <= right && px.y() >= -0.5 && px.y() <= bottom;
  };
  const auto areBeyond = [](double a, double b, double low, double high) {
    return (a < low && b < low) || (a > high && b > high);
  };
  const auto& [a, b] = unbounded;
  // Most segments end here.
  if (isInside(a) || isInside(b)) return true;
  if (areBeyond(a.x(), b.x(), -0.5, right) || areBeyond(a.y(), b.y(), -0.5, bottom)) return false;
  return inImage(unbounded).has_value();
}

std::optional<Segment2> projectSegmentUnbounded(const CameraIntrinsics& intrinsics,
                                                const Pose3& T_world_camera, const Segment3& segment_world) {
  return SegmentProjector(intrinsics, T_world_camera).unbounded(segment_world);
}

std::optional<Segment2> projectSegment(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                                       const Segment3& segment_world) {
  const SegmentProjector projector(intrinsics, T_world_camera);
  const auto whole = projector.unbounded(segment_world);
  return whole ? projector.inImage(*whole) : std::nullopt;
}

std::optional<Eigen::Vector3d> backProjectToGround(const CameraIntrinsics& intrinsics,
                                                   const Pose3& T_world_camera,
                                                   const Eigen::Vector2d& px_ideal, double max_range_m) {
  const Eigen::Vector3d d_world = T_world_camera.linear() * idealPixelRay(intrinsics, px_ideal);
  const Eigen::Vector3d& centre = T_world_camera.translation();
  if (centre.z() <= 0.0 || d_world.z() >= 0.0) return std::nullopt;
  const double scale = -centre.z() / d_world.z();
  const Eigen::Vector3d p{centre.x() + scale * d_world.x(), centre.y() + scale * d_world.y(), 0.0};
  const double range = (p - centre).head<2>().norm();
  if (!(range <= max_range_m)) return std::nullopt;
  return p;
}

HorizonLine horizonLine(const CameraIntrinsics& k, const Pose3& T_world_camera) {
  // A pixel's ray goes down when its world z is negative: r . ((u-cx)/fx, (v-cy)/fy, 1) < 0, r the third row.
  const Eigen::Vector3d r = T_world_camera.linear().row(2);
  HorizonLine line;
  line.normal = {-r.x() / k.fx, -r.y() / k.fy};
  line.offset = r.x() * k.cx / k.fx + r.y() * k.cy / k.fy - r.z();
  const double norm = line.normal.norm();
  constexpr double kVertical = 1e-12;
  if (norm < kVertical) return {Eigen::Vector2d::Zero(), r.z() < 0.0 ? 1.0 : -1.0};
  return {line.normal / norm, line.offset / norm};
}

}  // namespace vismem
