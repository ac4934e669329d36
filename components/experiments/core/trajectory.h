/// @file Poses over time: what the truth, odometry and localization leave behind. Pure.
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

/// Appends a pose; one that is not newer than the last is ignored. @return whether it was taken.
bool append(Trajectory& trajectory, const StampedPose& pose);

/// The pose at a stamp, interpolated between its neighbours.
/// @param max_gap_us neighbours further apart than this give no answer.
/// @return empty before the first and after the last pose and inside a gap.
std::optional<Pose2> poseAt(const Trajectory& trajectory, StampUs stamp_us, StampUs max_gap_us = kSecondUs);

/// The entry nearest in time; of two equally near ones the earlier. Null for an empty trajectory.
const StampedPose* nearestTo(const Trajectory& trajectory, StampUs stamp_us);

/// Moves every pose: result = T_a_b * pose.
Trajectory transform(const Pose2& T_a_b, const Trajectory& trajectory_b);

/// Length of the way [m].
double pathLength(const Trajectory& trajectory);

}  // namespace vismem
