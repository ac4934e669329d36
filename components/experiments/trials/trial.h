/// @file A recorded run with kidnappings, which any method of localization can be given. Pure. SPEC E5, E6.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "experiments/core/trajectory.h"

namespace vismem {

/// What one run leaves behind for every method alike: what the memory said after each image, and the truth.
struct Trial {
  std::uint64_t seed = 0;
  std::vector<MemoryUpdate> updates;  ///< stamps increase
  /// Odometry at the moment when each update came, which is later than its stamp where images are late.
  std::vector<Pose2> T_odom_robot_now;
  Trajectory truth;  ///< world -> robot
  /// When each event began: the first is the start of the run, the others are kidnappings. An event ends
  /// where the next begins, the last one with the truth.
  std::vector<StampUs> events_us;
  /// Where localization asked for gaze: CPU time of each decision about it, and how often it asked.
  std::vector<double> gaze_plan_ms;
  int gaze_wishes = 0;
};

/// The truth of one event alone: between two events lies no way. @param event index into events_us.
Trajectory truthOfEvent(const Trial& trial, std::size_t event);

}  // namespace vismem
