/// @file One camera of the simulated robot: its mounting, its exposures and its deliveries. Pure.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/robot/samples.h"
#include "simulator/core/image_errors.h"
#include "simulator/core/scene.h"

namespace vismem {

struct SimulatedCameraParams {
  std::string name = "cameraA";
  CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  /// The lens that its frames state; empty: the true one.
  std::optional<CameraIntrinsics> stated_intrinsics;
  double rate_hz = 30.0;
  double latency_s = 0.0;  ///< time from the exposure, which is the frame's stamp, to the delivery
  /// True: mounted on the head of the pan-tilt unit; false: on the robot's body.
  bool on_head = true;
  /// Optical centre and axes (x forward, y left, z up) on the head at pan = tilt = 0, or on the robot.
  Pose3 T_carrier_camera_body = Pose3::Identity();
  /// Extrinsic calibration error: true pose of the camera relative to T_carrier_camera_body.
  Pose3 T_believed_true = Pose3::Identity();
  /// Frames carry T_robot_camera from the robot's kinematics.
  bool reports_pose = false;
  /// Ground truth beside its frames: depth, and the visible models (TruthImages).
  bool depth = false;
  bool objects = false;
  ImageErrorParams errors;
};

/// @return empty if usable, otherwise the problem.
std::string checkCamera(const SimulatedCameraParams& camera);

/// A frame between exposure and delivery. It is rendered when it is taken; frames that are not taken cost no
/// rendering.
struct ExposedFrame {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  Pose3 T_world_camera = Pose3::Identity();  ///< the true one
  std::optional<Pose3> T_robot_camera;       ///< from the robot's kinematics
  double gain = 1.0;
  std::shared_ptr<const SceneState> scene;
};

/// *Single-threaded* (owner: the simulation).
class SimulatedCamera {
 public:
  SimulatedCamera(const SimulatedCameraParams& params, std::uint64_t seed)
      : params_(params), errors_(params.errors, seed) {}

  const SimulatedCameraParams& params() const { return params_; }
  const ImageErrors& errors() const { return errors_; }
  /// Stamp of the next exposure.
  StampUs nextExposure() const;
  /// Adds the frame of nextExposure(); sets its stamp, number and gain.
  void expose(ExposedFrame frame);
  /// The newest arrived frame; null without one since the last take().
  const ExposedFrame* arrived(StampUs now_us) const;
  /// As arrived(), and removes it; older frames are dropped.
  std::optional<ExposedFrame> take(StampUs now_us);

 private:
  SimulatedCameraParams params_;
  ImageErrors errors_;
  std::uint64_t frames_ = 0;
  std::deque<ExposedFrame> under_way_;
};

}  // namespace vismem
