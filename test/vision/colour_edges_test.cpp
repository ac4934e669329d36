#include "common/vision/colour_edges.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "common/vision/segment_extractor.h"

namespace vismem {
namespace {

/// A red box (54, the brightness of what is around it within 3 grey levels) on a dark floor.
cv::Mat redOnDark() {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(48, 52, 50));
  image(cv::Rect(100, 80, 120, 60)).setTo(cv::Scalar(130, 20, 26));
  return image;
}

std::size_t edgesFound(const cv::Mat& image, bool colour_edges) {
  ExtractorParams params;
  params.colour_edges = colour_edges;
  SegmentExtractor extractor(params, nullptr);
  CameraIntrinsics intrinsics;
  intrinsics.width = image.cols;
  intrinsics.height = image.rows;
  intrinsics.fx = intrinsics.fy = 277.0;
  intrinsics.cx = 159.5;
  intrinsics.cy = 119.5;
  return extractor.extract(image, intrinsics).size();
}

TEST(ColourEdges, ShowWhatTheGrayPictureHides) {
  EXPECT_EQ(edgesFound(redOnDark(), false), 0U);
  EXPECT_EQ(edgesFound(redOnDark(), true), 4U);
}

TEST(ColourEdges, AreNotFoundTwice) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(40, 44, 42));
  image(cv::Rect(100, 80, 120, 60)).setTo(cv::Scalar(230, 225, 228));
  EXPECT_EQ(edgesFound(image, false), 4U);
  EXPECT_EQ(edgesFound(image, true), 4U);
}

TEST(ColourEdges, ReplaceThePiecesOfAnEdge) {
  const cv::Mat image = redOnDark();
  std::vector<RawSegment> segments{{{{100.0, 80.0}, {140.0, 80.0}}, 10.0},
                                   {{{10.0, 10.0}, {10.0, 60.0}}, 50.0}};
  ColourEdgeJoiner().join(image, {{{{100.0, 80.0}, {220.0, 80.0}}, 80.0}}, segments);
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[0].px_raw.a.x(), 10.0);
  EXPECT_EQ(segments[1].px_raw.length(), 120.0);
}

}  // namespace
}  // namespace vismem
