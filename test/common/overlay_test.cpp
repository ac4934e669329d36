// Tests M11.
#include "common/visual_memory/overlay.h"

#include <gtest/gtest.h>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(Overlay, DrawsTheThreeSetsInTheirColours) {
  ImageAnalysis analysis;
  analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  analysis.T_robot_camera = cameraPose({}, 0.0, degToRad(-60.0));  // no horizon in view
  analysis.observed = {{{{20, 50}, {120, 50}}, "edge", 40.0}, {{{20, 150}, {120, 150}}, "edge", 40.0}};
  analysis.predicted = {{1, {{20, 50}, {120, 50}}, "edge"}, {2, {{20, 200}, {120, 200}}, "edge"}};
  analysis.matches = {{0, 0}};
  const cv::Mat canvas = drawAnalysis(cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)), analysis);
  const auto at = [&](int u, int v) { return canvas.at<cv::Vec3b>(v, u); };
  EXPECT_GT(at(70, 49)[1], at(70, 49)[2]) << "matched prediction: green";
  EXPECT_GT(at(70, 200)[0], 100) << "unobserved prediction: red";
  EXPECT_LT(at(70, 200)[2], 100);
  EXPECT_GT(at(70, 150)[2], 100) << "unpredicted observation: blue";
  EXPECT_EQ(drawAnalysis(cv::Mat(240, 320, CV_8UC3, cv::Scalar(0, 0, 0)), analysis, 2).size(),
            cv::Size(640, 480));
}

}  // namespace
}  // namespace vismem
