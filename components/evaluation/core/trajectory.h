/// @file Poses over time: of the truth, of odometry, of localization. Pure.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "common/robot/samples.h"

namespace vismem {

struct StampedPose {
  StampUs stamp_us = 0;
  Pose2 pose;
};

/// Stamps strictly increase. The frame is named where a trajectory is used.
using Trajectory = std::vector<StampedPose>;

/// Appends a pose if it is newer than the last one.
/// @return whether it was appended.
bool append(Trajectory& trajectory, const StampedPose& pose);

/// The pose at a stamp, interpolated between its neighbours.
/// @param max_gap_us largest time between the neighbours.
/// @return empty before the first pose, after the last pose, and inside a longer gap.
std::optional<Pose2> poseAt(const Trajectory& trajectory, StampUs stamp_us, StampUs max_gap_us = kSecondUs);

/// Moves every pose: result = T_a_b * pose.
Trajectory transform(const Pose2& T_a_b, const Trajectory& trajectory_b);

/// Length of the way [m].
double pathLength(const Trajectory& trajectory);

}  // namespace vismem
