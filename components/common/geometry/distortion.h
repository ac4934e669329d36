/// @file Invertibility of a lens distortion. Pure.
#pragma once

#include "common/geometry/camera.h"

namespace vismem {

/// @return whether undistortPixel has a solution in the whole image. A distortion that folds the image over
/// itself has none beyond the fold.
bool canUndistort(const CameraIntrinsics& intrinsics);

}  // namespace vismem
