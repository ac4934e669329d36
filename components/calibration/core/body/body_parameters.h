/// @file What `calibrate body` estimates: mounting, joints, wheels and time offsets of a robot, as one list
/// of named numbers. Pure. See B5.
///
/// Zeros of the joints are not in the list: the zero of the pan and the yaw of the unit turn about the same
/// axis, as do the zero of the tilt and the pitch of the camera. Only the sums are observable; they are the
/// unit's yaw and the camera's pitch here.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "common/geometry/camera.h"

namespace vismem {

/// Indices into BodyParameters::body.
enum BodyIndex : std::size_t {
  kUnitX,
  kUnitY,
  kUnitZ,
  kUnitRoll,
  kUnitPitch,
  kUnitYaw,  ///< plus the zero of the pan
  kCameraX,
  kCameraY,
  kCameraZ,
  kCameraRoll,
  kCameraPitch,  ///< plus the zero of the tilt
  kCameraYaw,
  kPanScale,
  kTiltScale,
  kAxisSkew,     ///< turn of the tilt axis about the head's x axis, off a right angle to the pan axis
  kPanBacklash,  ///< all of it: the head is half of it behind its motor, in the direction of the last motion
  kTiltBacklash,
  kJointDelay,
  kRowTime,
  kBoardHeight,  ///< of the board's frame above the floor
  kBoardRoll,    ///< of the board about its x axis, against its nominal pose
  kBoardPitch,   ///< the same about its y axis
  kBodySize
};

/// Indices into BodyParameters::lens.
enum LensIndex : std::size_t { kFx, kFy, kCx, kCy, kK1, kK2, kP1, kP2, kK3 };
inline constexpr std::size_t kLensSize = kK3 + 1;

/// Indices into BodyParameters::wheels.
enum WheelIndex : std::size_t { kLeftScale, kRightScale, kBase, kOdometryDelay };
inline constexpr std::size_t kWheelsSize = kOdometryDelay + 1;

/// The unknowns of a robot that do not change while it drives [m, rad, s, px].
struct BodyParameters {
  /// Mounting, joints, time of the joints, board. A reported joint angle r, stamped t, stands for the true
  /// angle scale * r - backlash / 2 * lead at t - delay (MotorLead). Camera on head and unit on robot
  /// as in CameraMount, rotations Rz(yaw) Ry(pitch) Rx(roll); the camera's axis is the ray of the principal
  /// point as described, so that the mounting is right for the described lens too. Row time: from one image
  /// row to the next; a frame's stamp is that of its middle row.
  std::array<double, kBodySize> body{};
  std::array<double, kLensSize> lens{};
  /// True travel of a wheel = scale * travel as reported by the odometry's own wheel radius and base; base:
  /// true distance of the wheels [m]; odometry stamped t stands for t - delay.
  std::array<double, kWheelsSize> wheels{};
};

/// One unknown in words.
struct ParameterInfo {
  std::string_view name;
  std::string_view unit;  ///< for people
  double to_unit = 1.0;   ///< value in SI times this is in `unit`
  /// An estimate with a larger standard deviation says nothing useful: the parameter is then called not
  /// observable [SI].
  double useful_sigma = 0.0;
  /// Standard deviation of the weak prior that keeps the solver in sane ranges [SI]. It never counts as
  /// knowledge.
  double weak_sigma = 0.0;
};

/// All unknowns in one order: body, lens, wheels.
inline constexpr std::size_t kParameterCount = kBodySize + kLensSize + kWheelsSize;
std::span<const ParameterInfo> parameterInfos();
double& parameterOf(BodyParameters& parameters, std::size_t index);
double parameterOf(const BodyParameters& parameters, std::size_t index);
constexpr std::size_t lensParameter(LensIndex index) {
  return kBodySize + static_cast<std::size_t>(index);
}
constexpr std::size_t wheelParameter(WheelIndex index) {
  return kBodySize + kLensSize + static_cast<std::size_t>(index);
}

/// A robot as it is described before its calibration: scales 1, no delays, the board on its nominal pose.
BodyParameters nominalBody(const CameraMount& mount, const CameraIntrinsics& intrinsics, double wheel_base_m);

CameraMount mountOf(const BodyParameters& parameters);

/// Pose of the camera frame on the robot for reported joint angles, without backlash. See G1.
Pose3 cameraPose(const BodyParameters& parameters, const PanTilt& reported);

/// The camera on the robot at joint readings 0: x, y, height [m], roll, tilt (up), yaw (left) [rad]. Roll: of
/// the image's x axis against the horizon, the right side down is positive.
using CameraPlace = Eigen::Matrix<double, 6, 1>;
CameraPlace placeOf(const Pose3& T_robot_camera);
/// Names and units of its entries.
std::span<const ParameterInfo> cameraPlaceInfos();

/// Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll), pitch in [-pi/2, pi/2].
Eigen::Vector3d rollPitchYaw(const Eigen::Matrix3d& R);

}  // namespace vismem
