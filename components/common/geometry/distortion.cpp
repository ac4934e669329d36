#include "common/geometry/distortion.h"

namespace vismem {

bool canUndistort(const CameraIntrinsics& k) {
  constexpr int kSteps = 16;
  constexpr double kTolerance_px = 0.1;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d raw((k.width - 1.0) * i / kSteps, (k.height - 1.0) * j / kSteps);
      // Written so that a NaN fails too.
      if (!((distortPixel(k, undistortPixel(k, raw)) - raw).norm() < kTolerance_px)) return false;
    }
  }
  return true;
}

}  // namespace vismem
