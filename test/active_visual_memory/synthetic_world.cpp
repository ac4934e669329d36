#include "active_visual_memory/synthetic_world.h"

#include <algorithm>

#include "common/geometry/angles.h"

namespace vismem::testing {
namespace {

void addLoop(std::vector<WorldSegment>& segments, const std::vector<Eigen::Vector3d>& corners,
             bool on_floor) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    segments.push_back({{corners[i], corners[(i + 1) % corners.size()]}, on_floor, 1.0, 0.0});
  }
}

std::vector<Eigen::Vector3d> rectangle(double x, double y, double w, double h, double z) {
  return {{x, y, z}, {x + w, y, z}, {x + w, y + h, z}, {x, y + h, z}};
}

}  // namespace

SyntheticWorld SyntheticWorld::room(std::uint64_t seed, bool boxes) {
  SyntheticWorld world;
  world.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  world.mount.T_robot_pantilt = poseFromXyzRpy(0.08, 0.0, 0.45, 0, 0, 0);
  world.random.seed(seed);
  addLoop(world.segments, rectangle(-3.0, -2.0, 6.0, 4.0, 0.0), true);
  addLoop(world.segments, rectangle(0.9, 0.5, 0.6, 0.4, 0.0), true);
  addLoop(world.segments, rectangle(-1.6, -1.2, 0.5, 0.5, 0.0), true);
  addLoop(world.segments, rectangle(0.6, -1.3, 0.8, 0.3, 0.0), true);
  addLoop(world.segments, {{-1.5, 0.6, 0.0}, {-0.9, 0.8, 0.0}, {-1.4, 1.3, 0.0}}, true);
  if (boxes) {
    addLoop(world.segments, rectangle(1.7, -0.5, 0.4, 0.4, 0.15), false);
    addLoop(world.segments, rectangle(-2.2, 0.2, 0.4, 0.3, 0.15), false);
  }
  return world;
}

RobotObservation SyntheticWorld::observe(StampUs stamp_us, const Pose2& pose, const PanTilt& head) const {
  RobotObservation observation;
  observation.frame.stamp_us = stamp_us;
  observation.frame.intrinsics = intrinsics;
  observation.T_odom_robot = pose;
  observation.pan_tilt = head;
  observation.T_robot_camera = cameraPose(mount, head.pan_rad, head.tilt_rad);
  return observation;
}

std::vector<ImageSegment> SyntheticWorld::detect(const RobotObservation& observation) {
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform;
  const Pose3 T_true_camera =
      toPose3(observation.T_odom_robot) *
      cameraPose(mount, observation.pan_tilt->pan_rad, observation.pan_tilt->tilt_rad + noise.tilt_bias_rad);
  const Eigen::Vector2d foot = T_true_camera.translation().head<2>();
  std::vector<ImageSegment> detected;
  const auto add = [&](Segment2 px) {
    if (px.length() < min_length_px) return;
    const Eigen::Vector2d u = (px.b - px.a).normalized();
    const Eigen::Vector2d n{-u.y(), u.x()};
    for (Eigen::Vector2d* end : {&px.a, &px.b}) {
      *end += noise.end_along_px * gauss(random) * u + noise.end_across_px * gauss(random) * n;
    }
    const auto inside = clipToBox(px, {1.0, 1.0}, {intrinsics.width - 2.0, intrinsics.height - 2.0});
    if (inside && inside->length() >= min_length_px) detected.push_back({*inside, "edge", 40.0});
  };
  for (WorldSegment& segment : segments) {
    // The detector resolves what lies within its range; everything seen is noted for the score.
    Segment3 near = segment.world;
    const int steps = 400;
    int first = -1;
    int last = -1;
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d p = near.a + (near.b - near.a) * i / steps;
      if ((p.head<2>() - foot).norm() > max_range_m) continue;
      if (first < 0) first = i;
      last = i;
    }
    if (last <= first) continue;
    const Segment3 part{near.a + (near.b - near.a) * first / steps,
                        near.a + (near.b - near.a) * last / steps};
    const auto px = projectSegment(intrinsics, T_true_camera, part);
    if (!px || px->length() < min_length_px || uniform(random) < noise.miss) continue;
    if (segment.on_floor) {
      const auto a = backProjectToGround(intrinsics, T_true_camera, px->a, 1e9);
      const auto b = backProjectToGround(intrinsics, T_true_camera, px->b, 1e9);
      const Segment2 floor = segment.world.floor();
      const double fa = projectionFraction(a->head<2>(), floor);
      const double fb = projectionFraction(b->head<2>(), floor);
      segment.seen_from = std::min({segment.seen_from, fa, fb});
      segment.seen_to = std::max({segment.seen_to, fa, fb});
    }
    if (uniform(random) < noise.broken && px->length() > 50.0) {
      const double at = 0.35 + 0.3 * uniform(random);
      const double gap = 3.0 / px->length();
      add({px->a, px->a + (at - gap) * (px->b - px->a)});
      add({px->a + (at + gap) * (px->b - px->a), px->b});
    } else {
      add(*px);
    }
  }
  if (uniform(random) < noise.false_per_image) {
    const Eigen::Vector2d a{uniform(random) * intrinsics.width, uniform(random) * intrinsics.height};
    const double direction = uniform(random) * std::numbers::pi;
    add({a, a + 30.0 * Eigen::Vector2d(std::cos(direction), std::sin(direction))});
  }
  return detected;
}

}  // namespace vismem::testing
