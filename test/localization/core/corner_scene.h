/// @file A map of two walls at a right angle, and what a robot remembers and sees of it.
#pragma once

#include <utility>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/map/map_index.h"

namespace vismem {

inline MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

inline MemorySegment remembered(double x1, double y1, double x2, double y2, double unseen_s = 0.0) {
  MemorySegment segment;
  segment.odom = {{x1, y1, 0.0}, {x2, y2, 0.0}};
  segment.label = "skirting";
  segment.confirmed = true;
  segment.last_seen_us = 100 * kSecondUs - static_cast<StampUs>(unseen_s * kSecondUs);
  return segment;
}

inline MemorySnapshot snapshotOf(std::vector<MemorySegment> segments) {
  MemorySnapshot snapshot;
  snapshot.stamp_us = 100 * kSecondUs;
  snapshot.segments = std::move(segments);
  return snapshot;
}

/// Two walls at a right angle: the pose is fully observable.
inline MapIndex cornerMap() {
  SegmentMap map;
  map.segments = {wall(0, 0, 3, 0), wall(0, 0, 0, 3)};
  MapIndex::Params params;
  params.direction_gate_rad = degToRad(20);
  return MapIndex(map, params);
}

/// A camera 1 m up that looks 45 degrees down at a line across the middle of its image.
inline ImageAnalysis lineAhead(double from_px, double to_px) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 1, 0, 0, 0);
  ImageAnalysis analysis;
  analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  analysis.T_robot_camera = cameraPose(mount, 0.0, degToRad(-45));
  analysis.observed = {{{{from_px, 119.5}, {to_px, 119.5}}, "skirting", 30.0}};
  return analysis;
}

}  // namespace vismem
