#include "common/vision/gap_split.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

/// A bright bar on dark ground with its upper edge at v = 40, from u = 10 to u = 110; another one comes from
/// above and joins it between u = 60 and u = 60 + `wide`.
cv::Mat joinedBars(int wide, int contrast) {
  cv::Mat image(80, 120, CV_8UC1, cv::Scalar(60));
  cv::rectangle(image, {10, 40, 100, 10}, cv::Scalar(60 + contrast), cv::FILLED);
  if (wide > 0) cv::rectangle(image, {60, 5, wide, 40}, cv::Scalar(60 + contrast), cv::FILLED);
  return image;
}

/// Its upper edge in one piece, brighter side on the left.
std::vector<ImageSegment> upperEdge(double strength) {
  return {{{{109.5, 39.5}, {9.5, 39.5}}, "edge", strength}};
}

std::vector<ImageSegment> split(const cv::Mat& image, double strength, bool enabled = true) {
  CameraIntrinsics k;
  k.width = image.cols;
  k.height = image.rows;
  GapSplitParams params;
  params.enabled = enabled;
  std::vector<ImageSegment> segments = upperEdge(strength);
  GapSplitter().split(image, k, segments, params);
  return segments;
}

TEST(GapSplit, CutsAnEdgeWhereAnotherLineJoins) {
  for (const int wide : {4, 7, 12}) {
    const auto pieces = split(joinedBars(wide, 100), 100.0);
    ASSERT_EQ(pieces.size(), 2U) << wide;
    EXPECT_NEAR(pieces[0].px.a.x(), 109.5, 1e-9);
    EXPECT_NEAR(pieces[0].px.b.x(), 59.5 + wide, 1.1) << wide;
    EXPECT_NEAR(pieces[1].px.a.x(), 59.5, 1.1) << wide;
    EXPECT_NEAR(pieces[1].px.b.x(), 9.5, 1e-9);
    for (const ImageSegment& piece : pieces) EXPECT_EQ(piece.label, "edge");
  }
}

TEST(GapSplit, LeavesWholeEdgesAndPixelsOfNoiseAlone) {
  EXPECT_EQ(split(joinedBars(0, 100), 100.0).size(), 1U);
  EXPECT_EQ(split(joinedBars(2, 100), 100.0).size(), 1U) << "two pixels are no gap";
  cv::Mat noisy = joinedBars(0, 60);
  cv::Mat noise(noisy.size(), CV_16SC1);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 8.0);
  cv::add(noisy, noise, noisy, cv::noArray(), CV_8U);
  EXPECT_EQ(split(noisy, 60.0).size(), 1U);
}

TEST(GapSplit, LeavesWeakEdgesAlone) {
  EXPECT_EQ(split(joinedBars(8, 12), 12.0).size(), 1U) << "noise would cut them anywhere";
}

}  // namespace
}  // namespace vismem
