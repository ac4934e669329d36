/// @file A robot with its camera 0.45 m above the floor, and the images that it takes of known segments:
/// shared by tests.
#pragma once

#include <vector>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {

inline CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

inline RobotObservation at(StampUs stamp_us, const Pose2& pose = {}, double pan_rad = 0.0,
                           double tilt_rad = -0.35) {
  RobotObservation o;
  o.frame.stamp_us = stamp_us;
  o.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  o.T_odom_robot = pose;
  o.pan_tilt = PanTilt{pan_rad, tilt_rad};
  o.T_robot_camera = cameraPose(mount(), pan_rad, tilt_rad);
  return o;
}

inline std::vector<ImageSegment> images(const RobotObservation& o, const std::vector<Segment3>& world) {
  std::vector<ImageSegment> seen;
  const Pose3 T = toPose3(o.T_odom_robot) * o.T_robot_camera;
  for (const Segment3& s : world) {
    if (const auto px = projectSegment(o.frame.intrinsics, T, s)) seen.push_back({*px, "edge", 40.0});
  }
  return seen;
}

inline AttentiveVisualMemoryParams standard() {
  AttentiveVisualMemoryParams p = AttentiveVisualMemoryParams::standard();
  p.rig.mount = mount();
  p.gaze.initial_mode = GazeMode::kOff;
  return p;
}

}  // namespace vismem
