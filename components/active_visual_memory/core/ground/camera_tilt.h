/// @file Error of the extrinsic rotation of the camera, and how it displaces points on the floor. Pure. See
/// M1, M6.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "common/geometry/pose.h"

namespace vismem {

/// Extrinsic rotation error [rad]: (mount roll, mount pitch, camera pitch, camera roll). The mount error
/// rotates about the x and y axes of the robot, the camera error about the x and z axes of the camera. The
/// two pairs are distinguishable only when the head turns. A rotation about the vertical is part of the
/// odometry drift.
using CameraTilt = Eigen::Vector4d;
using CameraTiltCovariance = Eigen::Matrix4d;
/// Derivative of one coordinate by the camera tilt [m/rad].
using TiltJacobianRow = Eigen::RowVector4d;
/// Derivative of a floor point by the camera tilt [m/rad]. Columns 0 and 1 are also those of a per-frame
/// tilt.
using TiltJacobian = Eigen::Matrix<double, 2, 4>;

/// Prior of the camera tilt: independent zero-mean errors.
struct TiltPrior {
  double mount_rad = 0.5 * std::numbers::pi / 180.0;       ///< sigma of the mount error; 0: not estimated
  double camera_rad = 0.5 * std::numbers::pi / 180.0;      ///< sigma of the camera error; 0: not estimated
  double per_frame_rad = 0.05 * std::numbers::pi / 180.0;  ///< sigma of the further tilt of single images
  double floor_rad = 0.03 * std::numbers::pi / 180.0;      ///< lower bound of the posterior sigma
  double max_sigmas = 4.0;                                 ///< bound of the estimate, in prior sigmas

  CameraTiltCovariance prior() const;
  bool enabled() const { return mount_rad > 0.0 || camera_rad > 0.0 || per_frame_rad > 0.0; }
};

/// Pose of the camera with its tilt error applied; the centre of projection stays.
Pose3 tilted(const Pose3& T_robot_camera, const CameraTilt& camera_tilt);

/// Centre and rotation axes of one view, which the tilt Jacobian of a floor point follows from. *Value.*
struct TiltView {
  Eigen::Vector3d camera = Eigen::Vector3d::Zero();  ///< centre of projection in odom [m]
  Eigen::Matrix<double, 3, 4> axes = Eigen::Matrix<double, 3, 4>::Zero();  ///< of the four rotations, in odom

  TiltView(const Pose3& T_odom_camera, double robot_heading_rad);

  /// Jacobian of the floor point p of a viewing ray. When an observation is compared with a remembered line,
  /// p is the remembered point: the Jacobian grows with distance, so the observed point would correlate it
  /// with the noise of the observation and bias the estimate.
  TiltJacobian derivativeAt(const Eigen::Vector2d& p) const;
};

/// The floor point whose viewing ray is that of p, rotated by `R` about the centre of projection `camera`.
/// @return p itself if the rotated ray does not meet the floor.
Eigen::Vector2d reprojectOnFloor(const Eigen::Vector2d& p, const Eigen::Vector3d& camera,
                                 const Eigen::Matrix3d& R);

}  // namespace vismem
