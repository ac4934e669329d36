// Tests M4.
#include "active_visual_memory/core/ground/line_gaps.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "active_visual_memory/core/ground/floor_evidence.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

const cv::Scalar kGrass(40, 120, 40);
const cv::Scalar kPaint(230, 230, 230);
const cv::Scalar kRobot(60, 60, 160);

CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
}

/// Paint above row 120, grass below: an edge along y = 119.5.
cv::Mat edgeImage() {
  cv::Mat image(240, 320, CV_8UC3, kGrass);
  image.rowRange(0, 120).setTo(kPaint);
  return image;
}

const Segment2 kEdge{{60, 119.5}, {260, 119.5}};

std::pmr::vector<LineGap> gapsOf(const cv::Mat& image) {
  return findLineGaps(image, camera(), kEdge);
}

GapShows shows(const cv::Mat& image, const LineGap& gap) {
  return FloorEvidence(image, camera(), {}).gap(kEdge, gap.from_px, gap.to_px);
}

TEST(LineGaps, AnEdgeWithoutOneHasNone) {
  EXPECT_TRUE(gapsOf(edgeImage()).empty());
  EXPECT_TRUE(gapsOf(cv::Mat(240, 320, CV_8UC3, kGrass)).empty()) << "no edge at all";
  EXPECT_TRUE(gapsOf({}).empty()) << "no image";
}

TEST(LineGaps, NoiseMakesNone) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 10.0);
  cv::Mat image = edgeImage();
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      for (int c = 0; c < 3; ++c) {
        auto& value = image.at<cv::Vec3b>(v, u)[c];
        value = cv::saturate_cast<unsigned char>(value + noise(random));
      }
    }
  }
  EXPECT_TRUE(gapsOf(image).empty());
}

TEST(LineGaps, PaintThatJoinsSplitsAnEdge) {
  cv::Mat image = edgeImage();
  // Columns 150 to 157: from x = 149.5 to 157.5, which is 89.5 to 97.5 from the edge's end.
  image(cv::Rect(150, 120, 8, 40)).setTo(kPaint);
  const auto gaps = gapsOf(image);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_NEAR(gaps[0].from_px, 89.5, 0.5);
  EXPECT_NEAR(gaps[0].to_px, 97.5, 0.5);
  EXPECT_EQ(shows(image, gaps[0]), GapShows::kFree);
}

TEST(LineGaps, APixelIsNoGap) {
  cv::Mat image = edgeImage();
  image(cv::Rect(150, 120, 1, 40)).setTo(kPaint);
  EXPECT_TRUE(gapsOf(image).empty());
}

TEST(LineGaps, ObjectsOnAnEdgeAreDistinguishedFromObjectsBeforeIt) {
  cv::Mat on_it = edgeImage();
  on_it(cv::Rect(150, 0, 10, 120)).setTo(kRobot);
  const auto there = gapsOf(on_it);
  ASSERT_EQ(there.size(), 1u);
  EXPECT_EQ(shows(on_it, there[0]), GapShows::kStandsThere) << "the grass before it shows";

  cv::Mat before_it = edgeImage();
  before_it(cv::Rect(150, 0, 10, 160)).setTo(kRobot);
  const auto before = gapsOf(before_it);
  ASSERT_EQ(before.size(), 1u);
  EXPECT_EQ(shows(before_it, before[0]), GapShows::kOccluded);
}

TEST(LineGaps, WhereAnEdgeEndsIsNoGap) {
  cv::Mat image = edgeImage();
  image(cv::Rect(250, 0, 70, 240)).setTo(kRobot);
  EXPECT_TRUE(gapsOf(image).empty());
}

/// A blurred line of 2 px along the row, its middle at y = 119.5, with bumps of `height_px` on rows from
/// 120.5 on.
cv::Mat narrowLine(double height_px, int from, int length, const cv::Scalar& colour = kPaint) {
  constexpr int kFine = 10;
  cv::Mat fine(240 * kFine, 320, CV_8UC3, kGrass);
  fine.rowRange(119 * kFine, 121 * kFine).setTo(kPaint);
  if (height_px > 0.0) {
    const int height = static_cast<int>(height_px * kFine);
    fine(cv::Rect(from, 121 * kFine, length, height)).setTo(colour);
  }
  cv::Mat image;
  cv::resize(fine, image, {320, 240}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

/// Its lower edge, with the line above (on its left).
std::pmr::vector<LineGap> bumpsOf(const cv::Mat& image) {
  return findLineBumps(image, camera(), {{60, 120.5}, {260, 120.5}}, false);
}

TEST(LineBumps, ALineThatIsThickNowhereHasNone) {
  EXPECT_TRUE(bumpsOf(narrowLine(0.0, 0, 0)).empty());
  EXPECT_TRUE(bumpsOf(cv::Mat(240, 320, CV_8UC3, kGrass)).empty()) << "no line at all";
  EXPECT_TRUE(bumpsOf({}).empty()) << "no image";
}

TEST(LineBumps, LessThanAPixelOfPaintSplitsTheEdgeOfANarrowLine) {
  for (const double height_px : {0.6, 1.0, 2.0}) {
    const auto bumps = bumpsOf(narrowLine(height_px, 150, 8));
    ASSERT_EQ(bumps.size(), 1u) << height_px;
    EXPECT_NEAR(bumps[0].from_px, 89.5, 0.6) << height_px;
    EXPECT_NEAR(bumps[0].to_px, 97.5, 0.6) << height_px;
  }
}

TEST(LineBumps, TheEdgeOnTheOtherSideStaysWhole) {
  const cv::Mat image = narrowLine(1.0, 150, 8);
  EXPECT_TRUE(findLineBumps(image, camera(), {{60, 118.5}, {260, 118.5}}, true).empty());
}

TEST(LineBumps, AnotherColourOnTheLineIsNoPaint) {
  EXPECT_TRUE(bumpsOf(narrowLine(2.0, 150, 8, kRobot)).empty());
}

TEST(LineBumps, NoiseMakesNone) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 6.0);
  int found = 0;
  for (int image_of = 0; image_of < 20; ++image_of) {
    cv::Mat image = narrowLine(0.0, 0, 0);
    for (int v = 110; v < 130; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        for (int c = 0; c < 3; ++c) {
          auto& value = image.at<cv::Vec3b>(v, u)[c];
          value = cv::saturate_cast<unsigned char>(value + noise(random));
        }
      }
    }
    found += static_cast<int>(bumpsOf(image).size());
  }
  EXPECT_EQ(found, 0);
}

}  // namespace
}  // namespace vismem
