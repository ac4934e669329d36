#include "common/vision/label_split.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

const Palette& palette() {
  static const Palette p = Palette::parse(
      "class.floor = saturation 0..30 value 0..30\nclass.door = hue 15..50 saturation 50..100 value 30..100\n"
      "class.wall = saturation 0..30 value 38..100\npair.skirting = floor wall\npair.door_foot = floor "
      "door\n",
      "test.palette");
  return p;
}

/// Floor below row 60, above it wall with a door from column `from` to `to`.
cv::Mat corridor(int from, int to) {
  cv::Mat image(120, 200, CV_8UC3, cv::Scalar(45, 47, 45));
  image.rowRange(0, 60).setTo(cv::Scalar(200, 196, 180));
  if (to > from) image(cv::Rect(from, 0, to - from, 60)).setTo(cv::Scalar(180, 106, 37));
  return image;
}

std::vector<LabelledPiece> split(const cv::Mat& image, const Segment2& px) {
  LabelSplitter splitter(palette(), {});
  const auto pieces = splitter.split(image, px, 10.0);
  return {pieces.begin(), pieces.end()};
}

const Segment2 kFoot{{5, 59.5}, {195, 59.5}};  // the brighter side above: left of a walk to the right

TEST(LabelSplit, CutsWhereADoorBeginsAndEnds) {
  const auto pieces = split(corridor(70, 120), kFoot);
  ASSERT_EQ(pieces.size(), 3u);
  EXPECT_EQ(*pieces[0].label, "skirting");
  EXPECT_EQ(*pieces[1].label, "door_foot");
  EXPECT_EQ(*pieces[2].label, "skirting");
  EXPECT_NEAR(pieces[1].px_raw.a.x(), 69.5, 0.3);
  EXPECT_NEAR(pieces[1].px_raw.b.x(), 119.5, 0.3);
  EXPECT_EQ(pieces[0].px_raw.a, kFoot.a);
  EXPECT_EQ(pieces[2].px_raw.b, kFoot.b);
}

TEST(LabelSplit, TheSidesOfADoorStandUprightHoweverItsFootRuns) {
  // Drawn five times as fine and made smaller, as a camera blends what it sees.
  constexpr int kFine = 5;
  for (const double slope : {-0.6, -0.3, 0.3, 0.6}) {
    const auto foot = [slope](double u) { return 60.0 + slope * (u - 100.0); };
    cv::Mat fine(140 * kFine, 200 * kFine, CV_8UC3, cv::Scalar(45, 47, 45));
    for (int row = 0; row < fine.rows; ++row) {
      for (int column = 0; column < fine.cols; ++column) {
        const double u = (column + 0.5) / kFine - 0.5;
        const double v = (row + 0.5) / kFine - 0.5;
        if (v > foot(u)) continue;
        const bool is_door = u > 70.3 && u < 120.8;
        fine.at<cv::Vec3b>(row, column) = is_door ? cv::Vec3b(180, 106, 37) : cv::Vec3b(200, 196, 180);
      }
    }
    cv::Mat image;
    cv::resize(fine, image, {200, 140}, 0, 0, cv::INTER_AREA);
    const auto pieces = split(image, {{30, foot(30)}, {170, foot(170)}});
    ASSERT_EQ(pieces.size(), 3u) << slope;
    EXPECT_NEAR(pieces[1].px_raw.a.x(), 70.3, 0.4) << slope;
    EXPECT_NEAR(pieces[1].px_raw.b.x(), 120.8, 0.4) << slope;
  }
}

TEST(LabelSplit, LeavesASegmentOfOneLabelWhole) {
  const auto pieces = split(corridor(0, 0), kFoot);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(*pieces[0].label, "skirting");
  EXPECT_EQ(pieces[0].px_raw.b, kFoot.b);
}

TEST(LabelSplit, ALabelThatHoldsTooShortlyDoesNotCount) {
  const auto pieces = split(corridor(90, 94), kFoot);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(*pieces[0].label, "skirting");
}

TEST(LabelSplit, UnknownStretchesNeitherCutNorJoinOtherLabels) {
  cv::Mat image = corridor(0, 0);
  image(cv::Rect(90, 0, 20, 60)).setTo(cv::Scalar(0, 0, 255));  // a class of its own: none
  EXPECT_EQ(split(image, kFoot).size(), 1u);
}

}  // namespace
}  // namespace vismem
