/// @file Start of the least squares of `calibrate body`: which views were taken at rest, and where the robot
/// stood at each. Pure.
#pragma once

#include <vector>

#include "calibration/core/body/body_problem.h"

namespace vismem {

/// By view: the head was still and the robot stood, whatever the time offsets within their bounds.
std::vector<bool> stillViews(const BodyRecord& record, const JointPath& joints, const WheelPath& wheels);

/// Robot poses by perspective-n-point at still views and by the wheels between them; views from one standing
/// place share a pose.
/// @param still the first view's must be true.
/// @throws std::runtime_error if the first view gives no pose.
BodyPoses startPoses(const BodyRecord& record, const WheelPath& wheels, const std::vector<bool>& still,
                     const BodyParameters& start);

/// Pose of the robot in world (x, y, heading) from the board's pose in the camera's frame and joint readings.
Eigen::Vector3d robotFromBoard(const Pose3& T_camera_board, BoardPlace place,
                               const BodyParameters& parameters, const PanTilt& reported);

/// The board's middle in the robot's frame, for BodyDrive::seen: in the direction that the described mounting
/// says, at the distance that the board's own plane says. A camera that is described as tilted wrongly would
/// get the distance wrong, and with it the ways around the board.
/// @param T_robot_camera as described.
Eigen::Vector3d middleFromRobot(const Pose3& T_robot_camera, const Pose3& T_camera_board,
                                const BoardSpec& board, BoardPlace place);

}  // namespace vismem
