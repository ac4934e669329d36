#include "active_visual_memory/core/ground/camera_tilt.h"

#include <Eigen/Geometry>

namespace vismem {
namespace {

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace

CameraTiltCovariance TiltPrior::prior() const {
  const double mount = mount_rad * mount_rad;
  const double camera = camera_rad * camera_rad;
  return CameraTilt(mount, mount, camera, camera).asDiagonal();
}

Pose3 tilted(const Pose3& T_robot_camera, const CameraTilt& camera_tilt) {
  Pose3 T = T_robot_camera;
  T.linear() = rotationOf({camera_tilt[0], camera_tilt[1], 0.0}) * T_robot_camera.linear() *
               rotationOf({camera_tilt[2], 0.0, camera_tilt[3]});
  return T;
}

TiltView::TiltView(const Pose3& T_odom_camera, double robot_heading_rad)
    : camera(T_odom_camera.translation()) {
  const double c = std::cos(robot_heading_rad);
  const double s = std::sin(robot_heading_rad);
  axes.col(0) = Eigen::Vector3d(c, s, 0.0);
  axes.col(1) = Eigen::Vector3d(-s, c, 0.0);
  axes.col(2) = T_odom_camera.linear().col(0);
  axes.col(3) = T_odom_camera.linear().col(2);
}

TiltJacobian TiltView::derivativeAt(const Eigen::Vector2d& p) const {
  const Eigen::Vector3d ray(p.x() - camera.x(), p.y() - camera.y(), -camera.z());
  TiltJacobian D;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d turned = Eigen::Vector3d(axes.col(i)).cross(ray);
    D.col(i) = turned.head<2>() - ray.head<2>() * (turned.z() / ray.z());
  }
  return D;
}

Eigen::Vector2d reprojectOnFloor(const Eigen::Vector2d& p, const Eigen::Vector3d& camera,
                                 const Eigen::Matrix3d& R) {
  const Eigen::Vector3d ray = R * (Eigen::Vector3d(p.x(), p.y(), 0.0) - camera);
  if (!(ray.z() < 0.0)) return p;
  return camera.head<2>() - camera.z() / ray.z() * ray.head<2>();
}

}  // namespace vismem
