#include "common/robot_ice/pose3d_ice.h"

#include <Eigen/Geometry>
#include <cmath>

#include "common/robot_ice/conversions.h"

namespace vismem {

jderobot::Pose3DData toPose3D(const Pose2& pose, double scale) {
  return {static_cast<float>(pose.x * scale),
          static_cast<float>(pose.y * scale),
          0.F,
          1.F,
          static_cast<float>(std::cos(pose.theta / 2)),
          0.F,
          0.F,
          static_cast<float>(std::sin(pose.theta / 2))};
}

std::optional<Pose2> fromPose3D(const jderobot::Pose3DData& d, double scale) {
  const Eigen::Quaterniond q(d.q0, d.q1, d.q2, d.q3);
  // Tolerance for rounding of clients; a length far from 1 is no rotation. Written so that a NaN fails too.
  if (!allFinite({d.x, d.y}) || !(std::abs(q.norm() - 1.0) < 0.1)) return std::nullopt;
  Pose3 pose = Pose3::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  return Pose2{d.x / scale, d.y / scale, toPose2(pose).theta};
}

}  // namespace vismem
