/// @file One image and its associations with the memory. Internal to SegmentMemory.
#pragma once

#include <vector>

#include "active_visual_memory/core/memory/segment_memory.h"

namespace vismem {

struct SegmentMemory::View {
  const RobotObservation& observation;
  Pose3 T_odom_camera;
  Eigen::Vector2d camera;  ///< the floor point below the camera [m]
  double height;
  double turn_rate;
  FloorEvidence evidence;
};

/// Which observed segments belong to which remembered ones.
struct SegmentMemory::Associations {
  std::vector<Expectation> expected;
  std::vector<int> index_of;                           ///< of the element, per expectation
  std::vector<std::vector<const FloorSegment*>> seen;  ///< matched and supporting ones, per expectation
  std::vector<bool> used;                              ///< per observed segment
  std::vector<ImageAnalysis::Match> matches;           ///< one-to-one
};

}  // namespace vismem
