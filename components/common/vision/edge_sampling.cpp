#include "common/vision/edge_sampling.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismem {

void checkPixelType(const cv::Mat& image) {
  if (image.type() == CV_8UC1 || image.type() == CV_8UC3) return;
  throw std::invalid_argument("image type " + cv::typeToString(image.type()) +
                              " (must be CV_8UC1 or CV_8UC3)");
}

cv::Mat toGray(const cv::Mat& image) {
  checkPixelType(image);
  if (image.type() == CV_8UC1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

double brightnessStep(const cv::Mat& image, const Segment2& px, double distance_px) {
  const double length = px.length();
  const int samples = std::clamp(static_cast<int>(length / 2.0), 3, 64);
  const Eigen::Vector2d aside = distance_px * leftNormal(px);
  const Eigen::Vector2d step = (px.b - px.a) / samples;
  const Eigen::Vector2d first = px.a + 0.5 * step;
  // Fixed point with 16 bits of fraction; half a pixel is added, so that what is above the fraction is the
  // nearest pixel.
  constexpr double kOne = 65536.0;
  const auto fixed = [](double value) { return static_cast<std::int64_t>(value * kOne); };
  const std::int64_t step_x = fixed(step.x());
  const std::int64_t step_y = fixed(step.y());
  const int channels = image.channels();
  std::int64_t sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int side = 0; side < 2; ++side) {
    const Eigen::Vector2d start = side == 0 ? Eigen::Vector2d(first + aside) : Eigen::Vector2d(first - aside);
    std::int64_t x = fixed(start.x() + 0.5);
    std::int64_t y = fixed(start.y() + 0.5);
    for (int i = 0; i < samples; ++i, x += step_x, y += step_y) {
      const std::int64_t column = x >> 16;
      const std::int64_t row = y >> 16;
      if (column < 0 || row < 0 || column >= image.cols || row >= image.rows) continue;
      sum[side] +=
          brightness(image.ptr<std::uint8_t>(static_cast<int>(row)), static_cast<int>(column), channels);
      ++count[side];
    }
  }
  if (count[0] == 0 || count[1] == 0) return 0.0;
  return static_cast<double>(sum[0]) / count[0] - static_cast<double>(sum[1]) / count[1];
}

OrientedSegment orientByBrightness(const cv::Mat& image, const Segment2& px, double distance_px) {
  const double step = brightnessStep(image, px, distance_px);
  if (step >= 0.0) return {px, step};
  return {{px.b, px.a}, -step};
}

}  // namespace vismem
