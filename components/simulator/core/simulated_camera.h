/// @file One camera of the simulated robot: where it sits, when it exposes and when it delivers. Pure.
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
  double rate_hz = 30.0;
  double latency_s = 0.0;  ///< from the exposure, whose stamp a frame carries, to its delivery
  /// It sits on the head that the pan-tilt unit moves, else on the robot's body.
  bool on_head = true;
  /// Optical centre and axes (x forward, y left, z up) on the head at pan = tilt = 0, or on the robot.
  Pose3 T_carrier_camera_body = Pose3::Identity();
  /// How it really sits beside what T_carrier_camera_body says: the calibration's error.
  Pose3 T_believed_true = Pose3::Identity();
  /// Its frames carry T_robot_camera as the robot's kinematics believe it.
  bool tells_pose = false;
  /// Ground truth beside its frames: depth, and which model is seen (TruthImages).
  bool depth = false;
  bool objects = false;
  ImageErrorParams errors;
};

/// @return empty if usable, otherwise what is wrong.
std::string checkCamera(const SimulatedCameraParams& camera);

/// A frame on its way from exposure to delivery. It is rendered when it is taken: what nobody takes costs
/// nothing.
struct ExposedFrame {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  Pose3 T_world_camera = Pose3::Identity();  ///< the true one
  std::optional<Pose3> T_robot_camera;       ///< as the robot believes it
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
  /// When the next frame is exposed.
  StampUs nextExposure() const;
  /// The frame of nextExposure(); its stamp, number and gain are set here.
  void expose(ExposedFrame frame);
  /// The newest frame that has arrived by now; empty if none has since the last one was taken.
  const ExposedFrame* arrived(StampUs now_us) const;
  /// The same, to keep; older ones are dropped.
  std::optional<ExposedFrame> take(StampUs now_us);

 private:
  SimulatedCameraParams params_;
  ImageErrors errors_;
  std::uint64_t frames_ = 0;
  std::deque<ExposedFrame> under_way_;
};

}  // namespace vismem
