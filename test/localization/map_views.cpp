#include "localization/map_views.h"

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem::test {
namespace {

constexpr double kCameraHeight_m = 0.45;

/// The part of a floor segment within a square around a point.
std::optional<Segment3> near(const Segment3& segment, const Eigen::Vector2d& p, double range_m) {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(range_m);
  const auto part = clipToBox(segment.floor(), p - reach, p + reach);
  if (!part) return std::nullopt;
  return Segment3{{part->a.x(), part->a.y(), 0.0}, {part->b.x(), part->b.y(), 0.0}};
}

}  // namespace

ImageAnalysis emptyView(double pan_rad, double tilt_rad) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, kCameraHeight_m, 0, 0, 0);
  ImageAnalysis view;
  view.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  view.T_robot_camera = cameraPose(mount, pan_rad, tilt_rad);
  return view;
}

void addMapSegments(ImageAnalysis& view, const SegmentMap& map, const Pose2& T_world_robot, double range_m) {
  const Pose3 T_world_camera = toPose3(T_world_robot) * view.T_robot_camera;
  for (const MapSegment& segment : map.segments) {
    const auto part = near(segment.world, T_world_robot.position(), range_m);
    if (!part) continue;
    const auto px = projectSegment(view.intrinsics, T_world_camera, *part);
    if (px && px->length() > 5.0) view.observed.push_back({*px, segment.label, 30.0});
  }
}

MemoryUpdate viewFrom(const SegmentMap& map, const Pose2& T_world_robot, StampUs stamp_us, double pan_rad,
                      double tilt_rad, double range_m) {
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = stamp_us;
  snapshot->T_odom_robot = T_world_robot;
  auto view = std::make_shared<ImageAnalysis>(emptyView(pan_rad, tilt_rad));
  view->stamp_us = stamp_us;
  view->T_odom_robot = T_world_robot;
  addMapSegments(*view, map, T_world_robot, range_m);
  return {snapshot, view};
}

void remember(MemorySnapshot& snapshot, const SegmentMap& map, const Pose2& T_world_robot, double range_m) {
  const Pose2 T_odom_world = snapshot.T_odom_robot * inverse(T_world_robot);
  for (const MapSegment& segment : map.segments) {
    const auto part = near(segment.world, T_world_robot.position(), range_m);
    if (!part || part->length() < 0.1) continue;
    MemorySegment one;
    one.id = snapshot.segments.size() + 1;
    one.odom = transform(T_odom_world, *part);
    one.label = segment.label;
    one.confirmed = true;
    one.life = 100.0;
    one.last_seen_us = snapshot.stamp_us;
    snapshot.segments.push_back(one);
  }
}

}  // namespace vismem::test
