// Images and memories of a map from a pose, for tests of localization without rendering.
#pragma once

#include <memory>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem::test {

/// A camera of 60 degrees at 320x240, 0.45 m up in the robot's middle.
ImageAnalysis emptyView(double pan_rad, double tilt_rad);

/// Adds the map's segments within `range_m` that project into the image, without occlusion.
/// @param view with intrinsics and camera pose.
/// @param range_m of a part of the segment, in plan view.
void addMapSegments(ImageAnalysis& view, const SegmentMap& map, const Pose2& T_world_robot,
                    double range_m = 4.0);

/// An image of such a camera as an update with an empty memory. Odometry equals the true pose.
MemoryUpdate viewFrom(const SegmentMap& map, const Pose2& T_world_robot, StampUs stamp_us, double pan_rad,
                      double tilt_rad, double range_m = 4.0);

/// Adds the map's parts within `range_m` of the robot to a snapshot: confirmed, just seen.
void remember(MemorySnapshot& snapshot, const SegmentMap& map, const Pose2& T_world_robot, double range_m);

}  // namespace vismem::test
