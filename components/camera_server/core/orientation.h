/// @file Rotation and mirroring of images of cameras that are mounted on their side, upside down, or look
/// into a mirror. Pure.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"

namespace vismem {

/// Rotation first, then mirroring.
struct Orientation {
  int quarter_turns = 0;  ///< clockwise, 0..3
  bool mirror = false;    ///< swaps left and right

  bool isPlain() const { return quarter_turns == 0 && !mirror; }
  bool swapsSides() const { return quarter_turns % 2 == 1; }
};

cv::Mat oriented(const cv::Mat& image, const Orientation& orientation);
/// The camera model of the oriented image: the projection of a point moves with its pixel. Directions are
/// rotated and mirrored with the image.
CameraIntrinsics oriented(CameraIntrinsics intrinsics, const Orientation& orientation);

}  // namespace vismem
