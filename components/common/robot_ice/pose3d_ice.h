/// @file Poses of the robot in the format of jderobot::Pose3D. See C4.
#pragma once

#include <jderobot/pose3d.h>

#include <optional>

#include "common/geometry/pose.h"

namespace vismem {

/// Quaternion w, x, y, z.
/// @param scale length units per metre: 1000 for clients that use millimetres.
jderobot::Pose3DData toPose3D(const Pose2& pose, double scale = 1.0);
/// @return empty unless position and quaternion are finite and the quaternion's length is about 1.
std::optional<Pose2> fromPose3D(const jderobot::Pose3DData& data, double scale = 1.0);

}  // namespace vismem
