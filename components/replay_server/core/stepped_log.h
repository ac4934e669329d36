/// @file A log as a robot in lock-step: every call delivers the next frame without waiting.
#pragma once

#include <memory>

#include "common/recording/robot_log.h"
#include "common/robot/ports.h"

namespace vismem {

/// Odometry and joints keep their own stamps: each step lets out those up to the first at or past the frame's
/// stamp. Commands are taken and ignored. *Single-threaded*; its ports are valid as long as it lives, their
/// waits return at once.
class SteppedLog : public SteppedRobot {
 public:
  explicit SteppedLog(RobotLog log);
  ~SteppedLog() override;

  /// @throws RecordingError for an image that cannot be decoded.
  bool advanceToNextFrame() override;
  FrameSource& camera() override;
  PanTiltUnit& panTilt() override;
  MobileBase& base() override;

  const RobotLog& log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
