#include "camera_server/core/orientation.h"

#include <opencv2/core.hpp>
#include <utility>

namespace vismem {

cv::Mat oriented(const cv::Mat& image, const Orientation& orientation) {
  cv::Mat result = image;
  if (orientation.quarter_turns > 0) {
    constexpr int kCodes[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE};
    cv::Mat turned;  // half a turn into `result` would turn the caller's pixels
    cv::rotate(image, turned, kCodes[orientation.quarter_turns - 1]);
    result = turned;
  }
  if (orientation.mirror) {
    cv::Mat mirrored;
    constexpr int kLeftRight = 1;
    cv::flip(result, mirrored, kLeftRight);
    result = mirrored;
  }
  return result;
}

CameraIntrinsics oriented(CameraIntrinsics k, const Orientation& orientation) {
  for (int i = 0; i < orientation.quarter_turns; ++i) {
    // Clockwise: u' = height - 1 - v, v' = u; a direction (x, y) becomes (-y, x). By Brown's formulas, p1' =
    // p2 and p2' = -p1.
    const double cx = k.cx;
    k.cx = k.height - 1 - k.cy;
    k.cy = cx;
    std::swap(k.fx, k.fy);
    std::swap(k.width, k.height);
    const double p1 = k.p1;
    k.p1 = k.p2;
    k.p2 = -p1;
  }
  if (orientation.mirror) {
    // u' = width - 1 - u; (x, y) becomes (-x, y).
    k.cx = k.width - 1 - k.cx;
    k.p2 = -k.p2;
  }
  return k;
}

}  // namespace vismem
