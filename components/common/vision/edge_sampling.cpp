#include "common/vision/edge_sampling.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismem {

cv::Mat toGray(const cv::Mat& image) {
  if (image.type() == CV_8UC1) return image;
  if (image.type() != CV_8UC3) {
    throw std::invalid_argument("image type " + cv::typeToString(image.type()) +
                                " (must be CV_8UC1 or CV_8UC3)");
  }
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

Eigen::Vector2d leftNormal(const Segment2& px) {
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  return {d.y(), -d.x()};
}

double brightnessStep(const cv::Mat& gray, const Segment2& px, double distance_px) {
  const double length = px.length();
  const Eigen::Vector2d aside = distance_px * leftNormal(px);
  const int samples = std::clamp(static_cast<int>(length / 2.0), 3, 64);
  int sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int i = 0; i < samples; ++i) {
    const Eigen::Vector2d on = px.a + (px.b - px.a) * ((i + 0.5) / samples);
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector2d p = side == 0 ? Eigen::Vector2d(on + aside) : Eigen::Vector2d(on - aside);
      const int x = static_cast<int>(std::lround(p.x()));
      const int y = static_cast<int>(std::lround(p.y()));
      if (x < 0 || y < 0 || x >= gray.cols || y >= gray.rows) continue;
      sum[side] += gray.at<std::uint8_t>(y, x);
      ++count[side];
    }
  }
  if (count[0] == 0 || count[1] == 0) return 0.0;
  return static_cast<double>(sum[0]) / count[0] - static_cast<double>(sum[1]) / count[1];
}

OrientedSegment orientByBrightness(const cv::Mat& gray, const Segment2& px, double distance_px) {
  const double step = brightnessStep(gray, px, distance_px);
  if (step >= 0.0) return {px, step};
  return {{px.b, px.a}, -step};
}

}  // namespace vismem
