/// @file Whether a lens's distortion can be undone. Pure.
#pragma once

#include "common/geometry/camera.h"

namespace vismem {

/// @return whether undistortPixel finds the way back from every part of the image: a distortion that folds the
/// image over itself has no ideal pixels.
bool canUndistort(const CameraIntrinsics& intrinsics);

}  // namespace vismem
