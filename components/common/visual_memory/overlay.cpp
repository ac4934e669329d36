#include "common/visual_memory/overlay.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

const cv::Scalar kMatchedPrediction(0, 200, 60);
const cv::Scalar kUnobserved(230, 40, 40);
const cv::Scalar kUnpredicted(50, 110, 255);
const cv::Scalar kMatchedObservation(250, 220, 60);
const cv::Scalar kHorizon(140, 140, 140);

/// A straight ideal segment is a curve in a raw image: drawn in pieces.
void drawIdeal(cv::Mat& canvas, const CameraIntrinsics& k, const Segment2& px, int scale,
               const cv::Scalar& colour, int thickness) {
  constexpr int kShift = 4;  // sixteenths of a pixel
  const int pieces = k.hasDistortion() ? 8 : 1;
  std::vector<cv::Point> points;
  for (int i = 0; i <= pieces; ++i) {
    const Eigen::Vector2d ideal = px.a + (px.b - px.a) * i / pieces;
    const Eigen::Vector2d raw = (distortPixel(k, ideal).array() + 0.5) * scale - 0.5;
    points.emplace_back(cvRound(raw.x() * (1 << kShift)), cvRound(raw.y() * (1 << kShift)));
  }
  cv::polylines(canvas, points, false, colour, thickness, cv::LINE_AA, kShift);
}

}  // namespace

cv::Mat drawAnalysis(const cv::Mat& image, const ImageAnalysis& analysis, int scale) {
  scale = std::clamp(scale, 1, 8);
  cv::Mat canvas;
  if (image.channels() == 1) {
    cv::cvtColor(image, canvas, cv::COLOR_GRAY2RGB);
  } else {
    canvas = image.clone();
  }
  const CameraIntrinsics& k = analysis.intrinsics;
  if (canvas.cols > k.width) cv::resize(canvas, canvas, {k.width, k.height}, 0, 0, cv::INTER_AREA);
  if (scale > 1) cv::resize(canvas, canvas, {}, scale, scale, cv::INTER_NEAREST);

  const HorizonLine horizon = horizonLine(k, toPose3(analysis.T_odom_robot) * analysis.T_robot_camera);
  if (!horizon.normal.isZero()) {
    const Eigen::Vector2d foot = -horizon.offset * horizon.normal;
    const Eigen::Vector2d along{-horizon.normal.y(), horizon.normal.x()};
    const double reach = 2.0 * (k.width + k.height);
    const Segment2 line{foot - reach * along, foot + reach * along};
    if (const auto px = clipToBox(line, {0, 0}, {k.width - 1.0, k.height - 1.0})) {
      drawIdeal(canvas, k, *px, scale, kHorizon, 1);
    }
  }
  std::vector<bool> observed_matched(analysis.observed.size(), false);
  std::vector<bool> predicted_matched(analysis.predicted.size(), false);
  for (const auto& match : analysis.matches) {
    observed_matched[match.observed] = true;
    predicted_matched[match.predicted] = true;
  }
  for (std::size_t i = 0; i < analysis.predicted.size(); ++i) {
    drawIdeal(canvas, k, analysis.predicted[i].px, scale,
              predicted_matched[i] ? kMatchedPrediction : kUnobserved, 2);
  }
  for (std::size_t i = 0; i < analysis.observed.size(); ++i) {
    drawIdeal(canvas, k, analysis.observed[i].px, scale,
              observed_matched[i] ? kMatchedObservation : kUnpredicted, 1);
  }
  return canvas;
}

}  // namespace vismem
