/// @file How far the camera leans from where the robot's kinematics put it, and what that does to places on
/// the floor. Pure. SPEC M1, M6.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "common/geometry/pose.h"

namespace vismem {

/// Rotations [rad] about the robot's x and y axes (the unit that carries the camera is mounted askew, the
/// body leans), then about the camera's own x and z axes (pitch and roll: the camera sits askew on its head).
/// The two pairs differ only when the head turns. Rotations about the vertical are none of it: they turn the
/// whole memory.
using Lean = Eigen::Vector4d;
using LeanCovariance = Eigen::Matrix4d;
/// Derivative of one coordinate by the lean.
using LeanRow = Eigen::RowVector4d;
/// Derivative of a floor point [m/rad]. Its first two columns are those of a sway of the body.
using FloorLean = Eigen::Matrix<double, 2, 4>;

struct LeanParams {
  double mount_rad =
      0.5 * std::numbers::pi / 180.0;  ///< sigma of the first two before anything was seen; 0: none
  double camera_rad = 0.5 * std::numbers::pi / 180.0;  ///< of the other two
  double sway_rad =
      0.05 * std::numbers::pi / 180.0;  ///< sigma of what the body leans in single images beside it
  double floor_rad = 0.03 * std::numbers::pi / 180.0;  ///< it never counts as better known than this
  double most_sigmas = 4.0;                            ///< it is never estimated larger than this

  LeanCovariance prior() const;
  bool enabled() const { return mount_rad > 0.0 || camera_rad > 0.0 || sway_rad > 0.0; }
};

/// Where the camera is when it leans so from where the kinematics put it. Its centre stays.
Pose3 leaned(const Pose3& T_robot_camera, const Lean& lean);

/// One view of the floor, as far as the lean matters. *Value.*
struct LeaningView {
  Eigen::Vector3d camera = Eigen::Vector3d::Zero();                        ///< its centre in odom [m]
  Eigen::Matrix<double, 3, 4> axes = Eigen::Matrix<double, 3, 4>::Zero();  ///< of the four rotations, in odom

  LeaningView(const Pose3& T_odom_camera, double robot_heading_rad);

  /// How the floor place p of a ray moves with the lean. For comparing what was observed with what was
  /// remembered, p is the remembered place: the derivative at a place that is observed too far is too large,
  /// and such pairs would tell of a lean where there is only noise.
  FloorLean derivativeAt(const Eigen::Vector2d& p) const;
};

/// Where the floor point p lies when the camera that saw it was turned by `R`, about its own centre, from
/// where it was taken to be. @return p itself when the turned ray does not go down.
Eigen::Vector2d turnedOnFloor(const Eigen::Vector2d& p, const Eigen::Vector3d& camera,
                              const Eigen::Matrix3d& R);

}  // namespace vismem
