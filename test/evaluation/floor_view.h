/// @file A camera that looks straight down on marked floor: common to the tests of memory scores.
#pragma once

#include <numbers>
#include <vector>

#include "evaluation/core/floor_truth.h"
#include "evaluation/core/memory_score.h"

namespace vismem {

inline SegmentMap mapOf(const std::vector<Segment2>& edges, const char* label = "edge") {
  SegmentMap map;
  for (const Segment2& e : edges) {
    map.segments.push_back({{{e.a.x(), e.a.y(), 0.0}, {e.b.x(), e.b.y(), 0.0}}, label, 0.0});
  }
  return map;
}

/// 1 m above the origin, looking straight down on a square of about 1.15 m.
inline Pose3 lookingDown(double x = 0.0, double y = 0.0) {
  Pose3 pose = Pose3::Identity();
  pose.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  pose.translation() << x, y, 1.0;
  return pose;
}

inline CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(240, 240, std::numbers::pi / 3.0);
}

inline const SeesFloor kNothingInTheWay = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };

inline RememberedEdge remembered(Segment2 s, bool confirmed = true) {
  return {1, s, "edge", confirmed};
}

}  // namespace vismem
