/// @file A recording of a robot: frames, odometry and joint angles with their own stamps. SPEC G1, G3;
/// DESIGN 11, 14.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/recording/bag_file.h"
#include "common/robot/samples.h"

namespace vismem {

/// What to take from a bag. Empty names are found by type; where several topics of a type exist, the name is
/// needed.
struct RobotLogOptions {
  std::string image_topic;        ///< sensor_msgs/Image (rgb8, bgr8, mono8) or sensor_msgs/CompressedImage
  std::string camera_info_topic;  ///< empty: the one beside the images, or the only one
  std::string odometry_topic;
  std::string joint_topic;
  std::string robot_frame;   ///< empty: base_footprint, else base_link
  std::string camera_frame;  ///< optical frame; empty: the images' frame_id
  std::string pan_joint;     ///< empty: head_yaw or pan
  std::string tilt_joint;    ///< empty: head_pitch or tilt
  /// +1: the recorded tilt is positive looking up; -1: looking down, as a Nao's head_pitch. 0: -1 for a joint
  /// called head_pitch, else +1.
  int tilt_sign = 0;
  StampUs max_gap_us = 500'000;  ///< transforms further apart than this are not interpolated between
};

/// The topics that were taken; empty where there is none.
struct RobotLogTopics {
  std::string image;
  std::string camera_info;
  std::string odometry;
  std::string joints;
  std::string pan_joint;
  std::string tilt_joint;
  std::string robot_frame;  ///< empty: camera poses are not in the log
  std::string camera_frame;
};

/// Invariant: at least one frame and two odometry samples; all stamps strictly increase within their list;
/// frame i has seq i, images are decoded on reading. *Single-threaded* (reading moves in the file).
class RobotLog {
 public:
  /// @throws RecordingError with the first thing wrong: file, topic, found, expected.
  static RobotLog open(const std::string& file, const RobotLogOptions& options = {});
  ~RobotLog();
  RobotLog(RobotLog&&) noexcept;
  RobotLog& operator=(RobotLog&&) noexcept;

  const std::string& file() const;
  const RobotLogTopics& topics() const;

  /// Capture stamps of all frames.
  const std::vector<StampUs>& frameStamps() const;
  /// @param index 0..frameStamps().size()-1. Image in the order R, G, B, or one grey channel; intrinsics;
  /// pose of the camera on the robot where the log has transforms.
  /// @throws RecordingError for an image that cannot be decoded or does not fit its camera info.
  Frame readFrame(std::size_t index) const;
  /// Of a frame, without decoding it.
  CameraIntrinsics intrinsics(std::size_t index) const;

  /// Whether frames carry T_robot_camera. Then all do: those without a transform at their stamp are left out.
  bool knowsCameraPose() const;
  std::size_t framesWithoutPose() const;  ///< how many were left out

  const std::vector<OdometrySample>& odometry() const;
  /// Empty when the log has no joints of those names. pan > 0 left, tilt > 0 up.
  const std::vector<PanTiltSample>& joints() const;

 private:
  struct Impl;
  explicit RobotLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
