/// @file Scenes of a few edges with a camera before them: for tests of visible pieces and of synthetic
/// vision.
#pragma once

#include <cmath>
#include <optional>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "experiments/trials/visible_pieces.h"

namespace vismem {

inline const CameraIntrinsics kIntrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));

/// 0.45 m above the floor, looking along x and a little down.
inline Pose3 camera() {
  return cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-15.0));
}

/// Free floor, brighter on the left of the x axis.
inline std::optional<SeenSurface> openFloor(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (direction.z() >= -1e-6) return std::nullopt;
  const double range = -origin.z() / direction.z();
  return SeenSurface{range, origin.y() + range * direction.y() > 0.0 ? 0.9 : 0.1};
}

inline SegmentMap lines() {
  SegmentMap map;
  map.segments = {{{{1.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, -0.5, 0.0}, {2.0, 0.5, 0.0}}, "door_foot", 0.0},
                  {{{-1.0, 0.0, 0.0}, {-3.0, 0.0, 0.0}}, "skirting", 0.0}};
  return map;
}

/// A post occludes the middle third of the cross line at x = 2: rays with |y / x| < 0.0833 end at 1.5 m.
inline std::optional<SeenSurface> floorBehindAPost(const Eigen::Vector3d& origin,
                                                   const Eigen::Vector3d& direction) {
  if (std::abs(direction.y() / direction.x()) < 1.0 / 12.0) return SeenSurface{1.5, 0.5};
  return openFloor(origin, direction);
}

/// A block of walls with its corner at (2, 0), and a wall across at x = 5 behind it.
inline std::optional<SeenSurface> blockBeforeAWall(const Eigen::Vector3d& origin,
                                                   const Eigen::Vector3d& direction) {
  const double to_front = (2.0 - origin.x()) / direction.x();
  const Eigen::Vector3d front = origin + to_front * direction;
  if (front.y() <= 0.0 && front.z() > 0.0) return SeenSurface{to_front, 0.9};
  const double to_back = (5.0 - origin.x()) / direction.x();
  if ((origin + to_back * direction).z() > 0.0) return SeenSurface{to_back, 0.9};
  return SeenSurface{-origin.z() / direction.z(), 0.2};
}

inline Pose3 cameraBesideTheCorner() {
  return cameraPose({poseFromXyzRpy(0, -0.3, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-15.0));
}

inline SegmentMap corner() {
  SegmentMap map;
  map.segments = {{{{2.0, -1.0, 0.0}, {2.0, 0.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, 0.0, 0.0}, {4.0, 0.0, 0.0}}, "skirting", 0.0}};
  return map;
}

}  // namespace vismem
