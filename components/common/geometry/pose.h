/// @file Poses in the plane and in space, and the maps between them. Pure.
/// `T_a_b` is the pose of frame b in frame a and maps coordinates of b to a; neighbours must match:
/// `T_world_camera = T_world_robot * T_robot_camera`.
#pragma once

#include <Eigen/Geometry>

namespace vismem {

/// A pose in the plane z = 0: position [m] and heading [rad], counter-clockwise from x.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  Eigen::Vector2d position() const { return {x, y}; }
  bool operator==(const Pose2&) const = default;
};

/// Composition; the heading is wrapped to (-pi, pi].
Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c);
Pose2 inverse(const Pose2& T_a_b);
Eigen::Vector2d transform(const Pose2& T_a_b, const Eigen::Vector2d& p_b);
/// Moves a point of space with the plane; z is kept.
Eigen::Vector3d transform(const Pose2& T_a_b, const Eigen::Vector3d& p_b);
/// Straight-line interpolation of the position, shortest turn of the heading. @param fraction in [0, 1].
Pose2 interpolate(const Pose2& from, const Pose2& to, double fraction);
bool isFinite(const Pose2& pose);

/// A rigid pose in space [m].
using Pose3 = Eigen::Isometry3d;

/// Rotation is Rz(yaw) * Ry(pitch) * Rx(roll), the convention of SDF and URDF.
Pose3 poseFromXyzRpy(double x, double y, double z, double roll, double pitch, double yaw);
Pose3 toPose3(const Pose2& pose);
/// Drops z, roll and pitch; the heading is that of the rotated x axis.
Pose2 toPose2(const Pose3& pose);
/// Linear position, spherical-linear rotation. @param fraction in [0, 1].
Pose3 interpolate(const Pose3& from, const Pose3& to, double fraction);

}  // namespace vismem
