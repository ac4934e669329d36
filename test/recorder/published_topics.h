/// @file Everything that the running application publishes, in simulated time, for tests of the recorder.
#pragma once

#include "recorder/ice/estimate_messages.h"
#include "recorder/ice/sensor_messages.h"

namespace vismem {

/// Raw images of 640x480 at 30 Hz, memory and localization at each image; odometry, joints and truth at 60
/// Hz, gaze at 10 Hz, the states of four components once a second. Their sizes are those of a drive in the
/// corridor. *Single-threaded.*
class PublishedTopics {
 public:
  static constexpr StampUs kFrame_us = 33'333;
  static constexpr int kFramesPerSecond = 30;

  PublishedTopics();

  /// What comes within the period of one image, as messages: each is copied and converted as in the process.
  /// @param image counted from 0; its stamp is image * kFrame_us.
  void publish(int image, const Emit& emit);

 private:
  const CameraMessages camera_{"/camera", ImageStorage::kCaptured};
  TruthMessages truth_;
  avm::Frame frame_;
  avm::MemoryUpdate update_;
  avm::PoseEstimate estimate_;
  avm::GazeStatus gaze_;
  avm::ComponentStatus status_;
};

}  // namespace vismem
