#include "evaluation/figures/segment_figure.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

constexpr double kMargin_px = 24.0;
constexpr double kHeader_px = 70.0;
constexpr double kRowTitle_px = 46.0;
constexpr double kCaptionLine_px = 15.0;
constexpr double kGap_px = 14.0;
constexpr double kLegend_px = 22.0;
constexpr double kLegendText_px = 30.0;
constexpr double kLegendSize = 8.5;
constexpr double kPaleness = 0.45;  // share of white: lines of any colour stand out

double captionHeight(const SegmentRow& row) {
  std::size_t lines = 0;
  for (const SegmentPanel& panel : row.panels) lines = std::max(lines, panel.caption.size());
  return kCaptionLine_px * static_cast<double>(lines) + 17.0;
}

int panelHeight(const SegmentRow& row, int width) {
  return static_cast<int>(std::lround(static_cast<double>(width) * row.image.rows / row.image.cols));
}

void drawPanel(Canvas& canvas, const SegmentRow& row, const SegmentPanel& panel, const Eigen::Vector2d& low,
               int width) {
  const int height = panelHeight(row, width);
  cv::Mat picture;
  cv::resize(row.image, picture, cv::Size(width, height), 0, 0,
             width < row.image.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  picture.convertTo(picture, -1, 1.0 - kPaleness, 255.0 * kPaleness);
  canvas.picture(picture, low);
  const double scale = static_cast<double>(width) / row.image.cols;
  // The centre of pixel 0 lies half a pixel inside the picture.
  const auto at = [&](const Eigen::Vector2d& px) {
    return Eigen::Vector2d(low + (px + Eigen::Vector2d::Constant(0.5)) * scale);
  };
  canvas.restrictTo(low, low + Eigen::Vector2d(width, height));
  for (const ColoredSegment& segment : panel.segments) {
    canvas.line(at(segment.px.a), at(segment.px.b), segment.color, 1.5);
    for (const Eigen::Vector2d& end : {segment.px.a, segment.px.b}) canvas.disc(at(end), 2.0, segment.color);
  }
  canvas.release();
  canvas.text(panel.title, low - Eigen::Vector2d(0, 8), 8.5, colors::kInk, Align::kLeft, true);
  double v = low.y() + height;
  for (const std::string& line : panel.caption) {
    v += kCaptionLine_px;
    canvas.text(line, {low.x(), v}, 8.0, colors::kFaintInk);
  }
}

double legendWidth(const LegendEntry& entry) {
  return kLegendText_px + Canvas(1, 1).textWidth(entry.text, kLegendSize) + 24.0;
}

/// As many entries a line as fit.
std::vector<std::vector<LegendEntry>> legendLines(const std::vector<LegendEntry>& entries, double width) {
  std::vector<std::vector<LegendEntry>> lines;
  double used = 0.0;
  for (const LegendEntry& entry : entries) {
    if (lines.empty() || used + legendWidth(entry) > width) {
      lines.emplace_back();
      used = 0.0;
    }
    lines.back().push_back(entry);
    used += legendWidth(entry);
  }
  return lines;
}

}  // namespace

cv::Mat drawSegmentFigure(const SegmentFigure& figure, int panel_width) {
  std::size_t columns = 1;
  double height = kHeader_px;
  for (const SegmentRow& row : figure.rows) {
    columns = std::max(columns, row.panels.size());
    height += kRowTitle_px + panelHeight(row, panel_width) + captionHeight(row);
  }
  const auto n = static_cast<double>(columns);
  const double width = 2 * kMargin_px + n * panel_width + (n - 1.0) * kGap_px;
  const auto lines = legendLines(figure.legend, width - 2 * kMargin_px);
  Canvas canvas(static_cast<int>(width),
                static_cast<int>(height + kLegend_px * static_cast<double>(lines.size())));
  canvas.text(figure.title, {kMargin_px, 32}, 13.0, colors::kInk, Align::kLeft, true);
  canvas.text(figure.subtitle, {kMargin_px, 52}, 8.5, colors::kFaintInk);
  double v = kHeader_px;
  for (const SegmentRow& row : figure.rows) {
    canvas.text(row.title, {kMargin_px, v + 14}, 9.5, colors::kEstimate, Align::kLeft, true);
    v += kRowTitle_px;
    double u = kMargin_px;
    for (const SegmentPanel& panel : row.panels) {
      drawPanel(canvas, row, panel, {u, v}, panel_width);
      u += panel_width + kGap_px;
    }
    v += panelHeight(row, panel_width) + captionHeight(row);
  }
  for (const auto& line : lines) {
    double u = kMargin_px;
    for (const LegendEntry& entry : line) {
      canvas.line({u, v + 4}, {u + 24, v + 4}, entry.color, 3.0);
      canvas.text(entry.text, {u + kLegendText_px, v + 8}, kLegendSize);
      u += legendWidth(entry);
    }
    v += kLegend_px;
  }
  return canvas.finish();
}

}  // namespace vismem
