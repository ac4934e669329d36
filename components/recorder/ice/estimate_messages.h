/// @file What memory, gaze, localization and components say, as ROS messages: standard ones and markers,
/// which RViz and Foxglove show, and everything as JSON beside them. Pure.
#pragma once

#include <avm/component.h>
#include <avm/gaze.h>
#include <avm/localization.h>
#include <avm/simulation.h>
#include <avm/visual_memory.h>

#include <optional>
#include <string>

#include "recorder/ice/sensor_messages.h"

namespace vismem {

/// /memory/segments and /memory/primitives (markers in odom), /memory/snapshot and /memory/analysis (JSON),
/// and the camera's pose that was used as frame "memory_camera" in /tf.
void convertMemory(const avm::MemoryUpdate& update, const Emit& emit);

/// /localization/pose, /localization/races (markers in map), /localization/estimate (JSON), map -> odom in
/// /tf.
void convertEstimate(const avm::PoseEstimate& estimate, const Emit& emit);

/// /gaze/target (markers in odom), /gaze/status (JSON).
void convertGaze(const avm::GazeStatus& status, const Emit& emit);

/// /ground_truth/pose, and /ground_truth/state (JSON) when that has changed. *Single-threaded.*
class TruthMessages {
 public:
  void convert(const avm::TruthSample& sample, const Emit& emit);

 private:
  std::optional<std::pair<bool, int>> state_;  ///< in collision, kidnappings
};

/// /components/NAME (JSON). @param stamp_us the newest of the robot: a component's own state has none.
void convertComponent(const avm::ComponentStatus& status, StampUs stamp_us, const Emit& emit);

}  // namespace vismem
