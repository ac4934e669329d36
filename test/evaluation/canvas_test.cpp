#include "evaluation/figures/canvas.h"

#include <gtest/gtest.h>

#include "support/picture_probe.h"

namespace vismem {
namespace {

TEST(Canvas, DrawsLinesAndAreasAtTheirPlace) {
  Canvas canvas(100, 60);
  canvas.line({10, 10}, {90, 10}, colors::kLost, 3.0);
  canvas.fill({{20, 30}, {40, 30}, {40, 50}, {20, 50}}, colors::kTruth);
  const cv::Mat picture = canvas.finish();
  ASSERT_EQ(picture.size(), cv::Size(100, 60));
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(distanceTo(picture, {50, 10}, colors::kLost), 0);
  EXPECT_EQ(distanceTo(picture, {30, 40}, colors::kTruth, 0), 0);
  EXPECT_EQ(distanceTo(picture, {50, 20}, colors::kPaper, 0), 0);
}

TEST(Canvas, KeepsInsideTheRestrictedRectangle) {
  Canvas canvas(100, 60);
  canvas.restrictTo({20, 10}, {60, 50});
  canvas.line({0, 30}, {100, 30}, colors::kLost, 3.0);
  canvas.release();
  canvas.line({0, 55}, {100, 55}, colors::kInk, 3.0);
  const cv::Mat picture = canvas.finish();
  EXPECT_EQ(distanceTo(picture, {40, 30}, colors::kLost), 0);
  EXPECT_EQ(distanceTo(picture, {10, 30}, colors::kPaper, 0), 0);
  EXPECT_EQ(distanceTo(picture, {80, 30}, colors::kPaper, 0), 0);
  EXPECT_EQ(distanceTo(picture, {80, 55}, colors::kInk), 0) << "released";
}

TEST(Canvas, TextGrowsWithItsSizeAndLetters) {
  const Canvas canvas(100, 60);
  EXPECT_GT(canvas.textWidth("two words", 10.0), canvas.textWidth("two", 10.0));
  EXPECT_GT(canvas.textWidth("two", 20.0), 1.8 * canvas.textWidth("two", 10.0));
}

TEST(CategoryColor, RepeatsAfterEight) {
  EXPECT_EQ(categoryColor(0), categoryColor(8));
  EXPECT_NE(categoryColor(0), categoryColor(1));
}

}  // namespace
}  // namespace vismem
