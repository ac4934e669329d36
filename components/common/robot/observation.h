/// @file A frame with the robot's state at the frame's stamp, and its assembly. Pure. Implements G3.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "common/robot/history.h"
#include "common/robot/samples.h"

namespace vismem {

/// All measurements of one instant.
struct RobotObservation {
  Frame frame;
  Pose2 T_odom_robot;
  Pose3 T_robot_camera = Pose3::Identity();
  /// Joint angles at the stamp; empty where the source has no pan-tilt unit.
  std::optional<PanTilt> pan_tilt;
  /// Grows with every jump of the source's time or odometry: older memory is then invalid.
  std::uint32_t epoch = 0;
};

/// Joins frames, pan-tilt and odometry by their stamps. *Single-threaded* (owner: the perception loop).
/// Invariant: an observation is complete only when both histories cover the frame's stamp. Frames older than
/// the histories are dropped and counted.
class ObservationAssembler {
 public:
  struct Params {
    CameraMount mount;             ///< used for frames that do not carry T_robot_camera
    bool has_pan_tilt = true;      ///< false: frames must carry T_robot_camera, no joint history is awaited
    StampUs max_gap_us = 500'000;  ///< samples further apart than this are not interpolated between
    double max_jump_m = 0.5;       ///< odometry that moves further than this between two samples is a jump
    double max_jump_rad = 1.0;
  };

  explicit ObservationAssembler(const Params& params);

  void add(Frame frame);
  void add(const PanTiltSample& sample);
  void add(const OdometrySample& sample);

  /// The newest frame that both histories cover; older frames are skipped. With `every_frame` the frames come
  /// one by one (logs, lock-step).
  std::optional<RobotObservation> take(bool every_frame = false);

  std::uint64_t droppedFrames() const { return dropped_frames_; }
  /// A new epoch begins when a source's time went back by over 1 s (restart, loop, seek), or odometry jumped
  /// or restarted (its sequence numbers went back). A restart that appears in several streams, one after the
  /// other, counts as one epoch.
  std::uint32_t epoch() const { return epoch_; }
  /// Reason of the present epoch, for people; empty for the first.
  const std::string& epochReason() const { return epoch_reason_; }
  /// Reason why take() returns nothing although frames arrive, for people: "no odometry has come", "the
  /// camera's stamps are 12.3 s ahead of the odometry's".
  std::string whyNothing() const;

 private:
  void beginEpoch(std::string reason);
  std::optional<RobotObservation> observe(const Frame& frame) const;

  Params params_;
  std::deque<Frame> frames_;
  SampleHistory<PanTiltSample> pan_tilt_;
  SampleHistory<OdometrySample> odometry_;
  StampUs newest_frame_us_ = 0;
  std::uint64_t dropped_frames_ = 0;
  std::uint32_t epoch_ = 0;
  std::string epoch_reason_;
};

}  // namespace vismem
