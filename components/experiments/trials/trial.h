/// @file A recorded run with kidnappings, input of every localization method. Pure. See E5, E6.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/trajectory.h"

namespace vismem {

/// The memory's updates of one run, and the truth.
struct Trial {
  std::uint64_t seed = 0;
  std::vector<MemoryUpdate> updates;  ///< stamps increase
  Trajectory truth;                   ///< world -> robot
  /// Begin of each event: the first is the start of the run, the others are kidnappings. An event ends at the
  /// begin of the next one, the last event with the truth.
  std::vector<StampUs> events_us;
  /// CPU time of each decision about gaze, and the number of gaze requests, when localization requests gaze.
  std::vector<double> gaze_plan_ms;
  int gaze_requests = 0;
};

/// The truth of one event: there is no path between two events.
/// @param event index into events_us.
Trajectory truthOfEvent(const Trial& trial, std::size_t event);

}  // namespace vismem
