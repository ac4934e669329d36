#include "common/geometry/pose.h"

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {

Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c) {
  const Eigen::Vector2d p = transform(T_a_b, T_b_c.position());
  return {p.x(), p.y(), wrapAngle(T_a_b.theta + T_b_c.theta)};
}

Pose2 inverse(const Pose2& T_a_b) {
  const double c = std::cos(T_a_b.theta);
  const double s = std::sin(T_a_b.theta);
  return {-c * T_a_b.x - s * T_a_b.y, s * T_a_b.x - c * T_a_b.y, wrapAngle(-T_a_b.theta)};
}

Eigen::Vector2d transform(const Pose2& T_a_b, const Eigen::Vector2d& p_b) {
  const double c = std::cos(T_a_b.theta);
  const double s = std::sin(T_a_b.theta);
  return {T_a_b.x + c * p_b.x() - s * p_b.y(), T_a_b.y + s * p_b.x() + c * p_b.y()};
}

Eigen::Vector3d transform(const Pose2& T_a_b, const Eigen::Vector3d& p_b) {
  const Eigen::Vector2d p = transform(T_a_b, Eigen::Vector2d(p_b.head<2>()));
  return {p.x(), p.y(), p_b.z()};
}

Pose2 interpolate(const Pose2& from, const Pose2& to, double fraction) {
  return {from.x + fraction * (to.x - from.x), from.y + fraction * (to.y - from.y),
          wrapAngle(from.theta + fraction * angleDifference(to.theta, from.theta))};
}

bool isFinite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

Pose3 poseFromXyzRpy(double x, double y, double z, double roll, double pitch, double yaw) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  Pose3 pose = Pose3::Identity();
  pose.linear() = (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
                   AngleAxisd(roll, Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = Vector3d(x, y, z);
  return pose;
}

Pose3 toPose3(const Pose2& pose) {
  return poseFromXyzRpy(pose.x, pose.y, 0.0, 0.0, 0.0, pose.theta);
}

Pose2 toPose2(const Pose3& pose) {
  const Eigen::Vector3d x_axis = pose.linear().col(0);
  return {pose.translation().x(), pose.translation().y(), std::atan2(x_axis.y(), x_axis.x())};
}

Pose3 interpolate(const Pose3& from, const Pose3& to, double fraction) {
  Pose3 pose = Pose3::Identity();
  pose.translation() = from.translation() + fraction * (to.translation() - from.translation());
  pose.linear() =
      Eigen::Quaterniond(from.linear()).slerp(fraction, Eigen::Quaterniond(to.linear())).toRotationMatrix();
  return pose;
}

}  // namespace vismem
