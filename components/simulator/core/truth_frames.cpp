#include "simulator/core/truth_frames.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr int kFarthest = 65534;

/// A frame of the same moment and camera, with three bytes a pixel given by `pixel(v, u)` and the place.
template <typename Pixel>
Frame frameLike(const Frame& image, Pixel pixel) {
  Frame frame = image;
  frame.image = cv::Mat(image.intrinsics.height, image.intrinsics.width, CV_8UC3);
  for (int v = 0; v < frame.image.rows; ++v) {
    for (int u = 0; u < frame.image.cols; ++u) frame.image.at<cv::Vec3b>(v, u) = pixel(v, u);
  }
  return frame;
}

std::uint8_t high(int value) {
  return static_cast<std::uint8_t>(value >> 8);
}
std::uint8_t low(int value) {
  return static_cast<std::uint8_t>(value & 0xff);
}

}  // namespace

Frame depthFrame(const TruthImages& truth, const Frame& image) {
  return frameLike(image, [&](int v, int u) {
    const double mm = 1000.0 * truth.depth_m.at<float>(v, u);
    int value = 0;
    if (std::isfinite(mm)) value = mm > kFarthest ? kFarthest + 1 : std::max(1, static_cast<int>(std::lround(mm)));
    return cv::Vec3b(high(value), low(value), 0);
  });
}

Frame objectFrame(const TruthImages& truth, const Frame& image) {
  return frameLike(image, [&](int v, int u) {
    const int model = truth.model.at<int>(v, u);
    if (model == TruthImages::kNothing) return cv::Vec3b(0, 0, 0);
    return cv::Vec3b(high(model + 1), low(model + 1),
                     static_cast<std::uint8_t>(std::min(255, truth.body.at<int>(v, u) + 1)));
  });
}

}  // namespace vismem
