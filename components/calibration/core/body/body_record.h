/// @file What a robot measured while it looked at the board: views, joint readings, odometry. Pure values.
#pragma once

#include <vector>

#include "calibration/core/board.h"
#include "common/robot/samples.h"

namespace vismem {

/// How the board lies.
enum class BoardPlace {
  kFloor,  ///< on the floor, its z axis up: the height of the camera is observable
  kWall    ///< upright, its y axis up: the height is not observable
};

/// Samples and views rise strictly in their stamps; the three sources may have time offsets among them.
struct BodyRecord {
  BoardSpec board;
  BoardPlace place = BoardPlace::kFloor;
  CameraIntrinsics intrinsics;  ///< as calibrated by the lens; image size
  std::vector<BoardView> views;
  std::vector<PanTiltSample> joints;
  std::vector<OdometrySample> odometry;
};

/// @return empty if usable, otherwise the problem for people.
std::string checkRecord(const BodyRecord& record);

}  // namespace vismem
