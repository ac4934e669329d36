/// @file One image as the memory sees it. Internal to SegmentMemory.
#pragma once

#include "active_visual_memory/core/segment_memory.h"

namespace vismem {

struct SegmentMemory::View {
  const RobotObservation& observation;
  Pose3 T_odom_camera;
  Eigen::Vector2d camera;  ///< the floor point below it
  double height;
  double turn_rate;
  FloorEvidence evidence;
};

}  // namespace vismem
