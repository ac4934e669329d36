/// @file Pictures of cameras that are mounted on their side, upside down, or look into a mirror. Pure.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"

namespace vismem {

/// First turned, then mirrored.
struct Orientation {
  int quarter_turns = 0;  ///< clockwise, 0..3
  bool mirror = false;    ///< left and right change places

  bool isPlain() const { return quarter_turns == 0 && !mirror; }
  bool swapsSides() const { return quarter_turns % 2 == 1; }
};

cv::Mat oriented(const cv::Mat& image, const Orientation& orientation);
/// The camera model of the oriented picture: a point that showed at a pixel shows where that pixel went.
/// Directions are turned and mirrored with the picture.
CameraIntrinsics oriented(CameraIntrinsics intrinsics, const Orientation& orientation);

}  // namespace vismem
