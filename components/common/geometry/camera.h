/// @file Pinhole camera with Brown-Conrady distortion, and its mount on a pan-tilt unit. Pure. Implements G1.
/// Camera frame: x right, y down, z forward. Pixels (u, v): u right, v down, centres on integers. Two kinds
/// of pixel exist: raw (as the sensor delivers them, distorted) and ideal (undistorted, same matrix). Images
/// are raw; all results of detection are ideal. Only detection and drawing use the distortion.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/geometry/pose.h"

namespace vismem {

/// Focal lengths and principal point [px], distortion in OpenCV's order and meaning (k1 k2 p1 p2 k3).
struct CameraIntrinsics {
  int width = 0;
  int height = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;

  bool hasDistortion() const { return k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0; }
  bool operator==(const CameraIntrinsics&) const = default;
};

/// Square pixels, principal point in the image's middle ((width - 1) / 2, (height - 1) / 2), no distortion.
/// @param horizontal_fov_rad between the outer borders of the first and last column, in (0, pi).
CameraIntrinsics intrinsicsFromFieldOfView(int width, int height, double horizontal_fov_rad);

/// @return empty if usable, otherwise the problem: field, value and rule.
std::string checkIntrinsics(const CameraIntrinsics& intrinsics);

/// Ideal pixel of a point in front of the camera.
/// @return empty for z <= 0 (at or behind the camera).
std::optional<Eigen::Vector2d> projectToIdeal(const CameraIntrinsics& intrinsics,
                                              const Eigen::Vector3d& p_camera);
/// Viewing direction of an ideal pixel, with z = 1 (not normalised).
Eigen::Vector3d idealPixelRay(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px_ideal);

/// Raw pixel of an ideal pixel.
Eigen::Vector2d distortPixel(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px_ideal);
/// Inverse of distortPixel, to 1e-5 px wherever the lens model has an inverse, also for strong distortion.
/// Beyond the fold of a model `px_raw` has no ideal pixel: the result is then the finite pixel with the
/// nearest image.
Eigen::Vector2d undistortPixel(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px_raw);

/// Mounting of a pan-tilt unit on the robot, and of the camera on its moving head.
struct CameraMount {
  /// Fixed base of the unit: at the crossing of its axes, x forward and z along the pan axis.
  Pose3 T_robot_pantilt = Pose3::Identity();
  /// Optical centre on the moving head at pan = tilt = 0; the head's frame is x forward, y left, z up.
  /// Its rotation is a residual misalignment: the turn from head axes to camera axes is already applied.
  Pose3 T_head_camera_body = Pose3::Identity();
};

/// Pose of the camera frame on the robot.
/// @param pan_rad > 0 looks left.
/// @param tilt_rad > 0 looks up.
Pose3 cameraPose(const CameraMount& mount, double pan_rad, double tilt_rad);

/// Pan and tilt that point the head's x axis at a point, ignoring the offset of the camera on the head.
struct PanTilt {
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
  bool operator==(const PanTilt&) const = default;
};
PanTilt panTiltTowards(const CameraMount& mount, const Eigen::Vector3d& p_robot);

/// Angle between the head's x axis at two directions [rad], in [0, pi].
double angleBetween(const PanTilt& a, const PanTilt& b);

}  // namespace vismem
