/// @file State of one hypothesis at one image: pose and camera tilt error. Pure. See B2, L12.
#pragma once

#include <Eigen/Core>

#include "common/geometry/angles.h"
#include "common/geometry/pose.h"

namespace vismem {

/// (x, y, theta, camera tilt about the robot's y axis, about its x axis) [m, m, rad, rad, rad].
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// Pose of the robot and tilt error of its camera when an image was taken. The tilt error is the rotation of
/// the camera relative to the kinematics, about the robot's y axis (positive looks down) and its x axis
/// (positive lowers the right side).
struct Placement {
  Pose2 T_world_robot;
  Eigen::Vector2d tilt_bias = Eigen::Vector2d::Zero();   ///< lasting part (Race::camera_tilt) [rad]
  Eigen::Vector2d frame_tilt = Eigen::Vector2d::Zero();  ///< part of this image alone [rad]

  Eigen::Vector2d tilt() const { return tilt_bias + frame_tilt; }
};

/// @param step in (x, y, theta).
inline Pose2 moved(const Pose2& pose, const Eigen::Vector3d& step) {
  return {pose.x + step.x(), pose.y + step.y(), wrapAngle(pose.theta + step.z())};
}

}  // namespace vismem
