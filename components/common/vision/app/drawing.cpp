#include "common/vision/app/drawing.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr int kCanvasWidth_px = 1000;
constexpr int kShift = 4;  // OpenCV's fixed point for drawing
constexpr double kTick_px = 2.0;

int magnification(const cv::Mat& image) {
  return std::max(1, kCanvasWidth_px / std::max(1, image.cols));
}

cv::Point fixedPoint(const Eigen::Vector2d& px, int scale) {
  // The centre of pixel 0 is at (scale - 1) / 2 of the enlarged picture.
  const Eigen::Vector2d p = (px * scale).array() + 0.5 * (scale - 1);
  return {static_cast<int>(std::lround(p.x() * (1 << kShift))),
          static_cast<int>(std::lround(p.y() * (1 << kShift)))};
}

}  // namespace

cv::Mat magnifiedForDrawing(const cv::Mat& image) {
  const int scale = magnification(image);
  cv::Mat canvas;
  if (image.channels() == 1) {
    cv::cvtColor(image, canvas, cv::COLOR_GRAY2RGB);
  } else {
    canvas = image.clone();  // an image that is not enlarged must stay as it is
  }
  cv::resize(canvas, canvas, cv::Size(), scale, scale, cv::INTER_NEAREST);
  return canvas;
}

void drawSegment(cv::Mat& canvas, const cv::Mat& image, const Segment2& px, const cv::Scalar& color_rgb) {
  const int scale = magnification(image);
  const Eigen::Vector2d tip = px.middle() + kTick_px * leftNormal(px);
  cv::line(canvas, fixedPoint(px.a, scale), fixedPoint(px.b, scale), color_rgb, 1, cv::LINE_AA, kShift);
  cv::line(canvas, fixedPoint(px.middle(), scale), fixedPoint(tip, scale), color_rgb, 1, cv::LINE_AA, kShift);
  for (const Eigen::Vector2d* end : {&px.a, &px.b}) {
    cv::circle(canvas, fixedPoint(*end, scale), 2 << kShift, color_rgb, cv::FILLED, cv::LINE_AA, kShift);
  }
}

}  // namespace vismem
