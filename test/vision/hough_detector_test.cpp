// Canny edges and the probabilistic Hough transform: the detector named `hough`, by worked examples.
// Tests V2.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "common/vision/segment_detector.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

std::vector<RawSegment> detectHough(const cv::Mat& image, const HoughParams& params = {}) {
  std::vector<RawSegment> out;
  makeHoughDetector(params)->detect(image, out);
  return out;
}

/// A bright step along column 160: brightness 60 left of it, 140 from it on.
cv::Mat verticalStep(int rows) {
  cv::Mat image(rows, 320, CV_8UC1, cv::Scalar(60));
  image.colRange(160, 320).setTo(140);
  return image;
}

// The edge lies between the columns 159 and 160; Canny marks one of them. It runs over all 240 rows.
TEST(HoughDetector, FindsAStepOfBrightnessWithinAPixel) {
  const auto found = detectHough(verticalStep(240));
  ASSERT_FALSE(found.empty());
  const auto longest = std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.px_raw.length() < b.px_raw.length();
  });
  EXPECT_NEAR(longest->px_raw.a.x(), 159.5, 1.0);
  EXPECT_NEAR(longest->px_raw.b.x(), 159.5, 1.0);
  EXPECT_GT(longest->px_raw.length(), 200.0);
}

// The right side is the brighter one, so the segment runs downwards: its left hand, as a person sees the
// picture, is the right side of the image.
TEST(HoughDetector, RunsWithTheBrighterSideOnTheLeft) {
  for (const auto& segment : detectHough(verticalStep(240))) {
    EXPECT_GT(segment.px_raw.b.y(), segment.px_raw.a.y());
  }
}

TEST(HoughDetector, LeavesOutWhatIsShorterThanTheMinimumLength) {
  HoughParams params;
  params.minimum_length_px = 60.0;
  const cv::Mat image = [] {
    cv::Mat square(240, 320, CV_8UC1, cv::Scalar(60));
    fillQuad(square, squareAt({160, 120}, 40, 0), cv::Scalar::all(140));
    return square;
  }();
  EXPECT_FALSE(detectHough(image).empty());  // sides of 40 px, the default minimum is 20
  EXPECT_TRUE(detectHough(image, params).empty());
}

TEST(HoughDetector, CannyThresholdsDecideWhichStepsAreEdges) {
  HoughParams deaf;
  deaf.canny_low = 600.0;
  deaf.canny_high = 700.0;  // a step of 80 grey levels has a Sobel gradient of 4 x 80 = 320
  EXPECT_FALSE(detectHough(verticalStep(120)).empty());
  EXPECT_TRUE(detectHough(verticalStep(120), deaf).empty());
}

TEST(HoughDetector, FindsNothingInAnEvenImage) {
  EXPECT_TRUE(detectHough(cv::Mat(240, 320, CV_8UC1, cv::Scalar(100))).empty());
}

}  // namespace
}  // namespace vismem
