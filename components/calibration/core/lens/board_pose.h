/// @file First pose of a board from the corners of one image. Pure.
#pragma once

#include <optional>

#include "calibration/core/board.h"
#include "common/geometry/camera.h"

namespace vismem {

/// Pose of the board in the camera's frame from the homography between the board and its ideal pixels
/// (normalised direct linear transform: Hartley and Zisserman, algorithm 4.2; Zhang 2000 for the pose): a
/// start for a fit.
/// @return empty for fewer than 4 corners, corners on one line, or a board behind the camera.
std::optional<Pose3> boardPoseFrom(const CameraIntrinsics& lens, const BoardSpec& board,
                                   const BoardView& view);

}  // namespace vismem
