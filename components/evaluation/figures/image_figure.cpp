#include "evaluation/figures/image_figure.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "active_visual_memory/core/overlay.h"
#include "evaluation/core/map_projection.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr double kMargin_px = 20.0;
constexpr double kHeader_px = 70.0;
constexpr double kFooter_px = 44.0;

/// The figure's pictures are at least this wide.
constexpr int kPictureWidth_px = 640;

cv::Mat inColor(const cv::Mat& image) {
  if (image.channels() == 3) return image.clone();
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_GRAY2RGB);
  return color;
}

/// A straight line is a curve in an image with distortion: drawn in pieces.
void drawIdeal(Canvas& canvas, const CameraIntrinsics& k, const Segment2& px, int scale,
               const Eigen::Vector2d& low, Rgb color, double width) {
  const int pieces = k.hasDistortion() ? 12 : 1;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= pieces; ++i) {
    const Eigen::Vector2d raw = distortPixel(k, px.a + (px.b - px.a) * i / pieces);
    points.emplace_back(low + (raw + Eigen::Vector2d::Constant(0.5)) * scale);
  }
  canvas.polyline(points, color, width);
}

double legendEntry(Canvas& canvas, double u, double v, Rgb color, const std::string& text) {
  canvas.line({u, v}, {u + 26.0, v}, color, 3.0);
  canvas.text(text, {u + 34.0, v + 5.0}, 9.5);
  return u + 34.0 + canvas.textWidth(text, 9.5) + 26.0;
}

}  // namespace

cv::Mat drawLastImage(const ImageFigure& figure) {
  const CameraIntrinsics& k = figure.analysis.intrinsics;
  const int scale = std::clamp((kPictureWidth_px + k.width - 1) / std::max(1, k.width), 1, 8);
  const double width = k.width * scale;
  const double height = k.height * scale;
  const bool two = figure.T_world_robot.has_value();
  Canvas canvas(static_cast<int>(two ? 2.0 * width + 3.0 * kMargin_px : width + 2.0 * kMargin_px),
                static_cast<int>(kHeader_px + height + kFooter_px));
  canvas.text(figure.title, {kMargin_px, 30.0}, 13.5, colors::kInk, Align::kLeft, true);

  const Eigen::Vector2d left(kMargin_px, kHeader_px);
  canvas.text("the image against the memory", left - Eigen::Vector2d(0, 9), 10.0, colors::kFaintInk);
  canvas.picture(drawAnalysis(figure.image, figure.analysis, scale), left);
  const std::size_t matches = figure.analysis.matches.size();
  double u = kMargin_px;
  const double legend_v = kHeader_px + height + 24.0;
  // The colours are those of drawAnalysis.
  u = legendEntry(canvas, u, legend_v, {0, 200, 60}, "matched (" + std::to_string(matches) + ")");
  u = legendEntry(canvas, u, legend_v, {230, 40, 40},
                  "predicted only (" + std::to_string(figure.analysis.predicted.size() - matches) + ")");
  legendEntry(canvas, u, legend_v, {50, 110, 255},
              "observed only (" + std::to_string(figure.analysis.observed.size() - matches) + ")");
  if (!two) return canvas.finish();

  const Eigen::Vector2d right(2.0 * kMargin_px + width, kHeader_px);
  canvas.text("the image against the map, projected with the estimated pose", right - Eigen::Vector2d(0, 9),
              10.0, colors::kFaintInk);
  cv::Mat plain;
  cv::resize(inColor(figure.image), plain, {}, scale, scale, cv::INTER_NEAREST);
  canvas.picture(plain, right);
  canvas.restrictTo(right, right + Eigen::Vector2d(width, height));
  const Pose3 T_world_camera = toPose3(*figure.T_world_robot) * figure.analysis.T_robot_camera;
  for (const ImageSegment& s : figure.analysis.observed) {
    if (s.label != kUnknownLabel) drawIdeal(canvas, k, s.px, scale, right, {250, 220, 60}, 2.5);
  }
  for (const Segment2& px : projectMap(figure.map_edges, k, T_world_camera, figure.map_range_m)) {
    drawIdeal(canvas, k, px, scale, right, colors::kMemory, 1.6);
  }
  canvas.release();
  u = legendEntry(canvas, right.x(), legend_v, colors::kMemory, "map");
  legendEntry(canvas, u, legend_v, {250, 220, 60}, "observed, with a label");
  return canvas.finish();
}

}  // namespace vismem
