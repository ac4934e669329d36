/// @file A recording of a robot: frames, odometry and joint angles with their own stamps. See G1,
/// G3.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/recording/bag_file.h"
#include "common/recording/log_topics.h"
#include "common/robot/samples.h"

namespace vismem {

/// Topics, frames and joints to read from a bag. Empty names are found by type; with several topics of a
/// type, the name is required, but for odometry that alone is in its frame.
struct RobotLogOptions {
  std::string image_topic;        ///< sensor_msgs/Image or sensor_msgs/CompressedImage
  std::string camera_info_topic;  ///< empty: the one beside the images, or the only one
  std::string odometry_topic;
  std::string joint_topic;
  std::string truth_topic;   ///< true poses; empty: /ground_truth/pose or /ground_truth, where there is one
  std::string robot_frame;   ///< empty: base_footprint, else base_link
  std::string camera_frame;  ///< optical frame; empty: the images' frame_id
  std::string odom_frame;    ///< of the odometry in transforms, and among several topics; empty: odom
  std::string pan_joint;     ///< empty: head_yaw or pan
  std::string tilt_joint;    ///< empty: head_pitch or tilt
  /// +1: the recorded tilt is positive looking up; -1: looking down, as a Nao's head_pitch. 0: -1 for a joint
  /// called head_pitch, else +1.
  int tilt_sign = 0;
  /// Added to the stamps of images [s]: the camera's pose and the odometry are then those of the later time.
  double late_s = 0.0;
  StampUs max_gap_us = 500'000;  ///< transforms further apart than this are not interpolated between
  /// Horizontal field of view of a camera whose calibration the bag lacks [rad]; 0: that is an error.
  double fov_rad = 0.0;
  /// The camera does not turn and nobody recorded its place: neither transforms nor joints are needed.
  bool fixed_camera = false;
};

/// The topics in use; empty where there is none.
struct RobotLogTopics {
  std::string image;
  std::string camera_info;
  std::string odometry;
  std::string joints;
  std::string truth;
  std::string pan_joint;
  std::string tilt_joint;
  std::string robot_frame;  ///< empty: camera poses are not in the log
  std::string camera_frame;
};

/// Invariant: at least one frame and two odometry samples; all stamps strictly increase within their list;
/// frame i has seq i, images are decoded on reading. *Single-threaded* (reading moves in the file).
class RobotLog {
 public:
  /// @throws RecordingError with everything that is missing, a line each: file, topic, found, expected.
  /// @param path a bag, or a folder with the parts of one.
  static RobotLog open(const std::string& path, const RobotLogOptions& options = {});
  /// Several bags as one recording.
  static RobotLog open(const std::vector<std::string>& paths, const RobotLogOptions& options);
  /// A bag that is open already: what it has unpacked is not unpacked again.
  static RobotLog open(BagFile bag, const RobotLogOptions& options);
  ~RobotLog();
  RobotLog(RobotLog&&) noexcept;
  RobotLog& operator=(RobotLog&&) noexcept;

  const std::string& file() const;
  const RobotLogTopics& topics() const;
  /// All topics of the bags, played or not, sorted by name.
  const std::vector<BagTopic>& contents() const;
  /// What was damaged or left out, and what was saved, for people.
  const std::vector<std::string>& notes() const;

  /// Capture stamps of all frames.
  const std::vector<StampUs>& frameStamps() const;
  /// @param index 0..frameStamps().size()-1. Image in the order R, G, B, or one grey channel; intrinsics;
  /// pose of the camera on the robot where the log has transforms.
  /// @throws RecordingError for an image that cannot be decoded or does not fit its camera info.
  /// @param native the frame may carry its picture as it was captured (Frame::native) in place of pixels.
  Frame readFrame(std::size_t index, bool native = false) const;
  /// Of a frame, without decoding it.
  CameraIntrinsics intrinsics(std::size_t index) const;

  /// Whether frames carry T_robot_camera. If so, all do: frames without a transform at their stamp are left
  /// out.
  bool knowsCameraPose() const;
  std::size_t framesWithoutPose() const;  ///< number of frames left out

  const std::vector<OdometrySample>& odometry() const;
  /// Of RobotLogTopics::truth; else empty.
  std::vector<TruePose> truth() const;
  /// Empty when the log has no joints of those names. pan > 0 left, tilt > 0 up.
  const std::vector<PanTiltSample>& joints() const;

 private:
  struct Impl;
  explicit RobotLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
