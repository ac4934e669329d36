#include "evaluation/figures/segment_figure.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace vismem {
namespace {

constexpr Rgb kRed{220, 20, 20};

int countOf(const cv::Mat& picture, Rgb color) {
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& p = picture.at<cv::Vec3b>(y, x);
      count +=
          std::abs(p[0] - color.r) < 12 && std::abs(p[1] - color.g) < 12 && std::abs(p[2] - color.b) < 12;
    }
  }
  return count;
}

SegmentFigure figure() {
  SegmentFigure result{"title", "subtitle", {}, {{"a label", kRed}}};
  SegmentRow row{"row", cv::Mat(60, 80, CV_8UC3, cv::Scalar::all(0)), {}};
  row.panels.push_back({"with", {"one segment"}, {{{{10, 30}, {70, 30}}, kRed}}});
  row.panels.push_back({"without", {"none", "a second line"}, {}});
  result.rows = {row, row};
  return result;
}

TEST(SegmentFigure, DrawsEachSegmentInItsPanelOnly) {
  const cv::Mat picture = drawSegmentFigure(figure(), 160);
  ASSERT_EQ(picture.type(), CV_8UC3);
  // Margins of 24, two panels of 160 and 14 between them.
  ASSERT_EQ(picture.cols, 24 + 160 + 14 + 160 + 24);
  SegmentFigure without_legend = figure();
  without_legend.legend.clear();
  const cv::Mat plain = drawSegmentFigure(without_legend, 160);
  EXPECT_GT(countOf(plain.colRange(24, 184), kRed), 2 * 100);  // twice 60 px of image at twice the size
  EXPECT_EQ(countOf(plain.colRange(198, plain.cols), kRed), 0);
  EXPECT_LT(plain.rows, picture.rows);
}

TEST(SegmentFigure, KeepsSegmentsThatLeaveTheImageInsideTheirPanel) {
  SegmentFigure far = figure();
  far.legend.clear();
  far.rows[0].panels[0].segments = {{{{-500, 30}, {900, 30}}, kRed}};
  far.rows[1].panels[0].segments.clear();
  const cv::Mat picture = drawSegmentFigure(far, 160);
  EXPECT_GT(countOf(picture.colRange(24, 184), kRed), 100);
  EXPECT_EQ(countOf(picture.colRange(0, 23), kRed) + countOf(picture.colRange(186, picture.cols), kRed), 0);
}

TEST(SegmentFigure, WrapsALegendThatIsTooLong) {
  SegmentFigure many = figure();
  const int rows = drawSegmentFigure(many, 160).rows;
  many.legend.assign(12, {"a label of some length", kRed});
  EXPECT_GE(drawSegmentFigure(many, 160).rows, rows + 2 * 22);
}

}  // namespace
}  // namespace vismem
