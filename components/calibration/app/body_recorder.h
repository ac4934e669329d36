/// @file Drives a robot through the views of `calibrate body` and records what it measures: over the ports,
/// so the same for a real robot, the simulator, and one in this process.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "calibration/core/body/body_drive.h"
#include "calibration/core/body/body_record.h"
#include "calibration/core/target/board_detector.h"
#include "common/robot/ports.h"

namespace vismem {

struct BodyRecorderOptions {
  BoardSpec board;
  BoardPlace place = BoardPlace::kFloor;
  CameraMount mount;  ///< as described
  /// Waits of the ports: how long a round may wait for an image.
  std::chrono::milliseconds frame_wait{10};
  /// False: images are taken only when one is worth looking at, which saves a simulator in this process their
  /// rendering. Lock-step needs a consumer of every image.
  bool every_frame = true;
  /// Called once a round, before the ports are read: moves the time of a stepped robot.
  std::function<void()> advance;
  /// Whether the user wants an end.
  std::function<bool()> stopped;
  /// The step of the plan, and the number of views so far.
  std::function<void(const BodyDrive&, std::size_t views)> progress;
};

/// Runs the plan to its end. The base is commanded at every round and stopped at the end, whatever happens.
/// @return the record, also of a drive that was stopped, with the reason in drive.whyStopped(): by the user;
/// no images, joints or odometry for 5 s, or commands of a port refused so long; a camera whose lens changes.
/// @throws std::runtime_error for a port that does not start, ConfigError for images with the camera's pose.
BodyRecord recordBody(FrameSource& camera, PanTiltUnit& head, MobileBase& base, BodyDrive& drive,
                      const BodyRecorderOptions& options);

}  // namespace vismem
