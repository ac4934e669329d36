/// @file Pictures with segments side by side: a row for each image, a column for each detector. Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/geometry/segment.h"
#include "evaluation/figures/canvas.h"

namespace vismem {

struct ColoredSegment {
  Segment2 px;  ///< raw pixels of the row's image, centres on integers
  Rgb color;
};

struct SegmentPanel {
  std::string title;                 ///< above the picture
  std::vector<std::string> caption;  ///< lines below it
  std::vector<ColoredSegment> segments;
};

struct SegmentRow {
  std::string title;
  cv::Mat image;  ///< CV_8UC3 (R, G, B)
  std::vector<SegmentPanel> panels;
};

struct LegendEntry {
  std::string text;
  Rgb color;
};

struct SegmentFigure {
  std::string title;
  std::string subtitle;
  std::vector<SegmentRow> rows;
  std::vector<LegendEntry> legend;
};

/// Every panel shows its row's image, paled, with its segments; dots mark their ends, so that gaps are
/// visible.
/// @param panel_width of each picture [px].
/// @return CV_8UC3 (R, G, B).
cv::Mat drawSegmentFigure(const SegmentFigure& figure, int panel_width);

}  // namespace vismem
