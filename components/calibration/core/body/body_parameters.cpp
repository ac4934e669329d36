#include "calibration/core/body/body_parameters.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kDeg = degToRad(1.0);
constexpr double kToDeg = radToDeg(1.0);

constexpr std::array<ParameterInfo, kParameterCount> kInfos{{
    {"unit x", "mm", 1e3, 0.02, 0.3},
    {"unit y", "mm", 1e3, 0.02, 0.3},
    {"unit height", "mm", 1e3, 0.02, 0.3},
    {"unit roll", "deg", kToDeg, kDeg, 10 * kDeg},
    {"unit pitch", "deg", kToDeg, kDeg, 10 * kDeg},
    {"unit yaw + zero of pan", "deg", kToDeg, 2 * kDeg, 30 * kDeg},
    {"camera on head x", "mm", 1e3, 0.02, 0.3},
    {"camera on head y", "mm", 1e3, 0.02, 0.3},
    {"camera on head z", "mm", 1e3, 0.02, 0.3},
    {"camera on head roll", "deg", kToDeg, kDeg, 10 * kDeg},
    {"camera on head pitch + zero of tilt", "deg", kToDeg, kDeg, 30 * kDeg},
    {"camera on head yaw", "deg", kToDeg, kDeg, 10 * kDeg},
    {"pan scale", "%", 100.0, 0.02, 0.2},
    {"tilt scale", "%", 100.0, 0.02, 0.2},
    {"skew of the axes", "deg", kToDeg, kDeg, 5 * kDeg},
    {"pan backlash", "deg", kToDeg, 0.2 * kDeg, 5 * kDeg},
    {"tilt backlash", "deg", kToDeg, 0.2 * kDeg, 5 * kDeg},
    {"delay of joints", "ms", 1e3, 0.02, 0.3},
    {"row time", "us", 1e6, 100e-6, 200e-6},
    {"board height", "mm", 1e3, 0.02, 0.5},
    {"board roll", "deg", kToDeg, kDeg, 20 * kDeg},
    {"board pitch", "deg", kToDeg, kDeg, 20 * kDeg},
    {"fx", "px", 1.0, 20.0, 1e3},
    {"fy", "px", 1.0, 20.0, 1e3},
    {"cx", "px", 1.0, 20.0, 1e3},
    {"cy", "px", 1.0, 20.0, 1e3},
    {"k1", "", 1.0, 0.2, 1.0},
    {"k2", "", 1.0, 0.5, 2.0},
    {"p1", "", 1.0, 0.02, 0.1},
    {"p2", "", 1.0, 0.02, 0.1},
    {"k3", "", 1.0, 1.0, 5.0},
    {"left wheel scale", "%", 100.0, 0.02, 0.2},
    {"right wheel scale", "%", 100.0, 0.02, 0.2},
    {"wheel base", "mm", 1e3, 0.01, 0.1},
    {"delay of odometry", "ms", 1e3, 0.05, 0.3},
}};

constexpr std::array<ParameterInfo, 6> kPlaceInfos{{
    {"camera x", "mm", 1e3, 0.02, 0.0},
    {"camera y", "mm", 1e3, 0.02, 0.0},
    {"camera height", "mm", 1e3, 0.02, 0.0},
    {"camera roll", "deg", kToDeg, kDeg, 0.0},
    {"camera tilt", "deg", kToDeg, kDeg, 0.0},
    {"camera yaw", "deg", kToDeg, 2 * kDeg, 0.0},
}};

}  // namespace

std::span<const ParameterInfo> cameraPlaceInfos() {
  return kPlaceInfos;
}

CameraPlace placeOf(const Pose3& T_robot_camera) {
  const Eigen::Vector3d ahead = T_robot_camera.linear().col(2);
  const Eigen::Vector3d right = T_robot_camera.linear().col(0);
  CameraPlace place;
  place << T_robot_camera.translation(), std::asin(std::clamp(-right.z(), -1.0, 1.0)),
      std::asin(std::clamp(ahead.z(), -1.0, 1.0)), std::atan2(ahead.y(), ahead.x());
  return place;
}

std::span<const ParameterInfo> parameterInfos() {
  return kInfos;
}

double& parameterOf(BodyParameters& p, std::size_t index) {
  if (index < kBodySize) return p.body[index];
  if (index < kBodySize + kLensSize) return p.lens[index - kBodySize];
  return p.wheels.at(index - kBodySize - kLensSize);
}

double parameterOf(const BodyParameters& p, std::size_t index) {
  return parameterOf(const_cast<BodyParameters&>(p), index);
}

Eigen::Vector3d rollPitchYaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
          std::atan2(R(1, 0), R(0, 0))};
}

BodyParameters nominalBody(const CameraMount& mount, const CameraIntrinsics& k, double wheel_base_m) {
  BodyParameters p;
  const auto put = [&](const Pose3& pose, std::size_t position, std::size_t rotation) {
    const Eigen::Vector3d t = pose.translation();
    const Eigen::Vector3d r = rollPitchYaw(pose.linear());
    for (int i = 0; i < 3; ++i) {
      p.body[position + i] = t[i];
      p.body[rotation + i] = r[i];
    }
  };
  put(mount.T_robot_pantilt, kUnitX, kUnitRoll);
  put(mount.T_head_camera_body, kCameraX, kCameraRoll);
  p.body[kPanScale] = p.body[kTiltScale] = 1.0;
  p.lens = {k.fx, k.fy, k.cx, k.cy, k.k1, k.k2, k.p1, k.p2, k.k3};
  p.wheels = {1.0, 1.0, wheel_base_m, 0.0};
  return p;
}

CameraMount mountOf(const BodyParameters& p) {
  const auto pose = [&](std::size_t t, std::size_t r) {
    return poseFromXyzRpy(p.body[t], p.body[t + 1], p.body[t + 2], p.body[r], p.body[r + 1], p.body[r + 2]);
  };
  return {pose(kUnitX, kUnitRoll), pose(kCameraX, kCameraRoll)};
}

Pose3 cameraPose(const BodyParameters& p, const PanTilt& reported) {
  CameraMount mount = mountOf(p);
  const double tilt = p.body[kTiltScale] * reported.tilt_rad;
  // The skew turns the tilt axis about the head's x axis, between pan and tilt.
  const Pose3 T_pan =
      mount.T_robot_pantilt * poseFromXyzRpy(0, 0, 0, 0, 0, p.body[kPanScale] * reported.pan_rad);
  mount.T_robot_pantilt = T_pan * poseFromXyzRpy(0, 0, 0, p.body[kAxisSkew], 0, 0);
  return cameraPose(mount, 0.0, tilt);
}

}  // namespace vismem
