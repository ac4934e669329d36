#include "evaluation/figures/image_figure.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/visual_memory/overlay.h"
#include "evaluation/core/map_projection.h"
#include "evaluation/figures/board.h"
#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

/// The figure's pictures are at least this wide.
constexpr int kPictureWidth_px = 640;
constexpr Rgb kLabelled{250, 220, 60};

cv::Mat inColor(const cv::Mat& image) {
  if (image.channels() == 3) return image.clone();
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_GRAY2RGB);
  return color;
}

/// A straight line is a curve in an image with distortion: drawn in pieces.
void drawIdeal(Canvas& canvas, const CameraIntrinsics& k, const Segment2& px, int scale, Rgb color,
               double width) {
  const int pieces = k.hasDistortion() ? 12 : 1;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= pieces; ++i) {
    const Eigen::Vector2d raw = distortPixel(k, px.a + (px.b - px.a) * i / pieces);
    points.emplace_back((raw + Eigen::Vector2d::Constant(0.5)) * scale);
  }
  canvas.polyline(points, color, width);
}

/// The image with the map projected into it.
cv::Mat drawProjection(const ImageFigure& figure, int scale) {
  const CameraIntrinsics& k = figure.analysis.intrinsics;
  cv::Mat plain;
  cv::resize(inColor(figure.image), plain, {k.width * scale, k.height * scale}, 0, 0, cv::INTER_NEAREST);
  Canvas canvas(plain.cols, plain.rows);
  canvas.picture(plain, {0.0, 0.0});
  const Pose3 T_world_camera = toPose3(*figure.T_world_robot) * figure.analysis.T_robot_camera;
  for (const ImageSegment& s : figure.analysis.observed) {
    if (s.label != kUnknownLabel) drawIdeal(canvas, k, s.px, scale, kLabelled, 2.5);
  }
  for (const Segment2& px : projectMap(figure.map_edges, k, T_world_camera, figure.map_range_m)) {
    drawIdeal(canvas, k, px, scale, colors::kMemory, 1.6);
  }
  return canvas.finish();
}

}  // namespace

cv::Mat drawLastImage(const ImageFigure& figure) {
  const ImageAnalysis& analysis = figure.analysis;
  const int width = std::max(1, analysis.intrinsics.width);
  const int scale = std::clamp((kPictureWidth_px + width - 1) / width, 1, 8);
  const std::size_t matches = analysis.matches.size();
  // The colours are those of drawAnalysis.
  Board board{
      figure.title,
      "",
      {{{"the image against the memory", {}, drawAnalysis(figure.image, analysis, scale), {}}}},
      {{"matched (" + std::to_string(matches) + ")", {0, 200, 60}},
       {"predicted only (" + std::to_string(analysis.predicted.size() - matches) + ")", {230, 40, 40}},
       {"observed only (" + std::to_string(analysis.observed.size() - matches) + ")", {50, 110, 255}}}};
  if (figure.T_world_robot) {
    board.rows.front().push_back({"the image against the map, projected with the estimated pose",
                                  {},
                                  drawProjection(figure, scale),
                                  {}});
    board.legend.push_back({"map", colors::kMemory});
    board.legend.push_back({"observed, with a label", kLabelled});
  }
  return drawBoard(board, width * scale);
}

}  // namespace vismem
