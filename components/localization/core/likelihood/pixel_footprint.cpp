#include "localization/core/likelihood/pixel_footprint.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace vismem {

// A ray r(u, v) from the camera's centre C, of length 1 along its axis, meets the floor at X = C + (h / s) r,
// where h is the camera's height and s = -r.z its sink. Pixels that differ by d show floor that differs by M
// d / (s + c . d), where c is the sink's gradient and M = h (A - (r / s) c^T) with r's gradient A: further
// than |M| |d| / (s - |c| |d|) it does not reach.

PixelFootprint::PixelFootprint(const CameraIntrinsics& k, const Pose3& T_robot_camera,
                               const Eigen::Vector2d& px) {
  const Eigen::Vector3d ray = T_robot_camera.linear() * idealPixelRay(k, px);
  const Eigen::Vector3d centre = T_robot_camera.translation();
  const Eigen::Vector3d by_u = T_robot_camera.linear().col(0) / k.fx;
  const Eigen::Vector3d by_v = T_robot_camera.linear().col(1) / k.fy;
  const Eigen::Vector2d gradient(-by_u.z(), -by_v.z());
  sink_ = -ray.z();
  sink_per_px_ = gradient.norm();
  constexpr double kLeastSink = 1e-6;  // beyond it the floor is farther than any map
  if (!(centre.z() > 0.0) || !(sink_ > kLeastSink)) return;
  is_on_floor_ = true;
  p_robot_ = centre.head<2>() + centre.z() / sink_ * ray.head<2>();
  Eigen::Matrix2d ray_gradient;
  ray_gradient << by_u.head<2>(), by_v.head<2>();
  const Eigen::Matrix2d M = centre.z() * (ray_gradient - ray.head<2>() / sink_ * gradient.transpose());
  // The larger singular value of two by two.
  const double squares = M.squaredNorm();
  const double det = M.determinant();
  spread_ = std::sqrt(0.5 * (squares + std::sqrt(std::max(0.0, squares * squares - 4.0 * det * det))));
}

double PixelFootprint::radius(double px) const {
  const double left = sink_ - sink_per_px_ * px;
  return is_on_floor_ && left > 0.0 ? spread_ * px / left : std::numeric_limits<double>::infinity();
}

double PixelFootprint::reach(double radius_m) const {
  if (!is_on_floor_ || !(radius_m > 0.0)) return 0.0;
  return radius_m * sink_ / (spread_ + radius_m * sink_per_px_);
}

FloorDisc floorWithin(std::span<const PixelFootprint> pixels, double px, double most_radius_m) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const PixelFootprint& pixel : pixels) {
    const double radius = pixel.radius(px);
    if (!(radius <= most_radius_m)) continue;
    low = low.cwiseMin((pixel.p_robot().array() - radius).matrix());
    high = high.cwiseMax((pixel.p_robot().array() + radius).matrix());
  }
  FloorDisc disc;
  if (!(low.x() <= high.x())) return disc;
  disc.middle = 0.5 * (low + high);
  for (const PixelFootprint& pixel : pixels) {
    const double radius = pixel.radius(px);
    if (!(radius <= most_radius_m)) continue;
    disc.radius_m = std::max(disc.radius_m, (pixel.p_robot() - disc.middle).norm() + radius);
  }
  return disc;
}

}  // namespace vismem
