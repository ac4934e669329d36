#include "common/geometry/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Brown-Conrady: normalised ideal coordinates to normalised distorted ones.
Eigen::Vector2d distortNormalised(const CameraIntrinsics& k, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k.k1 + r2 * (k.k2 + r2 * k.k3));
  return {x * radial + 2.0 * k.p1 * x * y + k.p2 * (r2 + 2.0 * x * x),
          y * radial + k.p1 * (r2 + 2.0 * y * y) + 2.0 * k.p2 * x * y};
}

/// Derivative of distortNormalised.
Eigen::Matrix2d distortionSlope(const CameraIntrinsics& k, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k.k1 + r2 * (k.k2 + r2 * k.k3));
  const double radial_slope = 2.0 * (k.k1 + r2 * (2.0 * k.k2 + r2 * 3.0 * k.k3));  // by r2, twice
  const double mixed = radial_slope * x * y + 2.0 * k.p1 * x + 2.0 * k.p2 * y;
  Eigen::Matrix2d slope;
  slope << radial + radial_slope * x * x + 2.0 * k.p1 * y + 6.0 * k.p2 * x, mixed, mixed,
      radial + radial_slope * y * y + 6.0 * k.p1 * y + 2.0 * k.p2 * x;
  return slope;
}

Eigen::Vector2d toNormalised(const CameraIntrinsics& k, const Eigen::Vector2d& px) {
  return {(px.x() - k.cx) / k.fx, (px.y() - k.cy) / k.fy};
}

Eigen::Vector2d toPixel(const CameraIntrinsics& k, const Eigen::Vector2d& n) {
  return {k.fx * n.x() + k.cx, k.fy * n.y() + k.cy};
}

}  // namespace

CameraIntrinsics intrinsicsFromFieldOfView(int width, int height, double horizontal_fov_rad) {
  CameraIntrinsics intrinsics;
  intrinsics.width = width;
  intrinsics.height = height;
  intrinsics.fx = intrinsics.fy = 0.5 * width / std::tan(0.5 * horizontal_fov_rad);
  intrinsics.cx = 0.5 * (width - 1);
  intrinsics.cy = 0.5 * (height - 1);
  return intrinsics;
}

std::string checkIntrinsics(const CameraIntrinsics& k) {
  std::ostringstream problem;
  if (k.width < 16 || k.width > 16384 || k.height < 16 || k.height > 16384) {
    problem << "image size " << k.width << "x" << k.height << " (must be 16..16384 each way)";
  } else if (!(k.fx > 0.0) || !(k.fy > 0.0) || !std::isfinite(k.fx) || !std::isfinite(k.fy)) {
    problem << "focal length " << k.fx << ", " << k.fy << " px (must be positive)";
  } else if (!std::isfinite(k.cx) || !std::isfinite(k.cy)) {
    problem << "principal point " << k.cx << ", " << k.cy << " px (must be finite)";
  } else if (!std::isfinite(k.k1 + k.k2 + k.p1 + k.p2 + k.k3)) {
    problem << "distortion has a coefficient that is not finite";
  }
  return problem.str();
}

std::optional<Eigen::Vector2d> projectToIdeal(const CameraIntrinsics& k, const Eigen::Vector3d& p) {
  if (!(p.z() > 0.0)) return std::nullopt;
  return toPixel(k, {p.x() / p.z(), p.y() / p.z()});
}

Eigen::Vector3d idealPixelRay(const CameraIntrinsics& k, const Eigen::Vector2d& px_ideal) {
  return toNormalised(k, px_ideal).homogeneous();
}

Eigen::Vector2d distortPixel(const CameraIntrinsics& k, const Eigen::Vector2d& px_ideal) {
  if (!k.hasDistortion()) return px_ideal;
  return toPixel(k, distortNormalised(k, toNormalised(k, px_ideal)));
}

Eigen::Vector2d undistortPixel(const CameraIntrinsics& k, const Eigen::Vector2d& px_raw) {
  if (!k.hasDistortion()) return px_raw;
  constexpr int kMaxIterations = 30;
  constexpr int kMaxHalvings = 8;
  constexpr double kTolerance = 1e-10;  // about 3e-8 px at a focal length of 300 px
  const Eigen::Vector2d target = toNormalised(k, px_raw);
  Eigen::Vector2d n = target;
  Eigen::Vector2d error = distortNormalised(k, n) - target;
  // Newton's method with step halving until the error decreases: the result is finite also without an
  // inverse.
  for (int i = 0; i < kMaxIterations && error.squaredNorm() > kTolerance * kTolerance; ++i) {
    const Eigen::Matrix2d slope = distortionSlope(k, n);
    const double determinant = slope.determinant();
    Eigen::Vector2d step = error;
    if (std::abs(determinant) > 1e-9) {
      step = Eigen::Vector2d(slope(1, 1) * error.x() - slope(0, 1) * error.y(),
                             slope(0, 0) * error.y() - slope(1, 0) * error.x()) /
             determinant;
    }
    bool better = false;
    for (int halvings = 0; halvings < kMaxHalvings && !better; ++halvings, step *= 0.5) {
      const Eigen::Vector2d next = n - step;
      const Eigen::Vector2d next_error = distortNormalised(k, next) - target;
      better = next_error.squaredNorm() < error.squaredNorm();
      if (!better) continue;
      n = next;
      error = next_error;
    }
    if (!better) break;
  }
  return toPixel(k, n);
}

Pose3 cameraPose(const CameraMount& mount, double pan_rad, double tilt_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  // Camera axes on the head: its z looks along the head's x, its x along -y, its y along -z.
  static const Eigen::Matrix3d R_body_camera = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  Pose3 T_pantilt_head = Pose3::Identity();
  T_pantilt_head.linear() =
      (AngleAxisd(pan_rad, Vector3d::UnitZ()) * AngleAxisd(-tilt_rad, Vector3d::UnitY())).toRotationMatrix();
  Pose3 T_robot_camera = mount.T_robot_pantilt * T_pantilt_head * mount.T_head_camera_body;
  T_robot_camera.linear() = T_robot_camera.linear() * R_body_camera;
  return T_robot_camera;
}

PanTilt panTiltTowards(const CameraMount& mount, const Eigen::Vector3d& p_robot) {
  const Eigen::Vector3d p = mount.T_robot_pantilt.inverse() * p_robot;
  return {std::atan2(p.y(), p.x()), std::atan2(p.z(), std::hypot(p.x(), p.y()))};
}

double angleBetween(const PanTilt& a, const PanTilt& b) {
  const auto axis = [](const PanTilt& d) -> Eigen::Vector3d {
    return {std::cos(d.tilt_rad) * std::cos(d.pan_rad), std::cos(d.tilt_rad) * std::sin(d.pan_rad),
            std::sin(d.tilt_rad)};
  };
  return std::acos(std::clamp(axis(a).dot(axis(b)), -1.0, 1.0));
}

}  // namespace vismem
