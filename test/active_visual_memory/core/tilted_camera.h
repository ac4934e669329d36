/// @file A camera on a pan-tilt unit, and the floor as it sees it with a tilt error.
#pragma once

#include <random>
#include <vector>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "active_visual_memory/core/ground/ground_projector.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {

inline CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0.05, 0, 0.45, 0, 0, 0);
  return m;
}

/// The image of lines on the floor by a tilted camera, with half a pixel of noise.
inline std::pmr::vector<FloorSegment> seenTilted(const std::vector<Segment3>& lines,
                                                 const Pose3& T_robot_camera, const CameraTilt& camera_tilt,
                                                 std::mt19937_64& random) {
  const auto k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  std::normal_distribution<double> noise(0.0, 0.5);
  std::vector<ImageSegment> observed;
  for (const Segment3& line : lines) {
    auto px = projectSegment(k, tilted(T_robot_camera, camera_tilt), line);
    if (!px) continue;
    px->a += Eigen::Vector2d(noise(random), noise(random));
    px->b += Eigen::Vector2d(noise(random), noise(random));
    observed.push_back({*px, "edge", 40.0});
  }
  return GroundProjector({}).project(k, T_robot_camera, observed);
}

}  // namespace vismem
