// What a keyframe keeps of the segments of its image. Tests B6.
#include "mapper/core/keyframe_recorder.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "common/geometry/angles.h"
#include "common/vision/reduced_image.h"

namespace vismem {
namespace {

constexpr int kRow = 160;

/// A view of the floor with a line in row 160, seen by a camera that looks 30 degrees down.
class OneLine {
 public:
  OneLine() {
    CameraMount mount;
    mount.T_robot_pantilt.translation().z() = 0.5;
    observation.frame.stamp_us = 1'000'000;
    observation.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
    observation.T_robot_camera = cameraPose(mount, 0.0, degToRad(-30.0));
    observation.frame.image = cv::Mat(240, 320, CV_8UC3, cv::Scalar(45, 45, 45));
  }
  /// @param side_px, value  of the side above the row.
  void paint(int from, int to, int side_px, int value) {
    cv::rectangle(observation.frame.image, {from, kRow - side_px, to - from, side_px},
                  cv::Scalar(value, value, value), cv::FILLED);
  }
  LineSighting recorded(double from, double to) { return recorded(from, to, observation.frame.intrinsics); }
  /// @param seen  lens of the image that the memory analysed.
  LineSighting recorded(double from, double to, const CameraIntrinsics& seen) {
    auto analysis = std::make_shared<ImageAnalysis>();
    analysis->stamp_us = observation.frame.stamp_us;
    ImageSegment segment;
    segment.px = {{from, kRow - 0.5}, {to, kRow - 0.5}};
    segment.label = "marking";
    analysis->observed = {segment};
    analysis->predicted = {{7, segment.px, "marking"}};
    analysis->matches = {{0, 0}};
    analysis->intrinsics = seen;
    analysis->T_robot_camera = observation.T_robot_camera;
    auto snapshot = std::make_shared<MemorySnapshot>();
    KeyframeParams params;
    params.projector.end_short_px = 1.0;
    KeyframeRecorder recorder(params);
    EXPECT_TRUE(recorder.add(observation.frame, {snapshot, analysis}, snapshot->segments));
    const DriveRecord& record = recorder.record();
    EXPECT_EQ(record.keyframes.at(0).sightings.size(), 1U);
    return record.keyframes.at(0).sightings.at(0);
  }

  RobotObservation observation;
};

TEST(KeyframeRecorder, AStripeEndsWhereAShadowGoesOnInItsLine) {
  OneLine view;
  view.paint(0, 320, 100, 58);   // lit floor above, shaded below
  view.paint(60, 200, 12, 235);  // the stripe
  const LineSighting sighting = view.recorded(60, 290);
  EXPECT_NEAR(sighting.px.b.x(), 200.0, 3.0);
  EXPECT_FALSE(sighting.censored_b);
  EXPECT_NEAR(sighting.px.a.x(), 60.0, 3.0);
  EXPECT_FALSE(sighting.censored_a);
}

// A fine camera: the memory saw the mean of 2 x 2 pixels, and so does the keyframe.
TEST(KeyframeRecorder, AFineImageIsJudgedAsTheMemorySawIt) {
  OneLine view;
  view.paint(0, 320, 100, 58);
  view.paint(60, 200, 12, 235);
  const CameraIntrinsics seen = view.observation.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, 0.52);
  Frame& frame = view.observation.frame;
  cv::resize(frame.image, frame.image, {640, 480}, 0, 0, cv::INTER_NEAREST);
  frame.intrinsics = intrinsicsFromFieldOfView(640, 480, 0.52);
  ASSERT_EQ(blockSize(frame.intrinsics), 2);
  const LineSighting sighting = view.recorded(60, 290, seen);
  EXPECT_NEAR(sighting.px.b.x(), 200.0, 3.0);
  EXPECT_NEAR(sighting.px.a.x(), 60.0, 3.0);
}

TEST(KeyframeRecorder, AnEvenlyFaintEdgeStaysWhole) {
  OneLine view;
  view.paint(0, 320, 100, 58);
  const LineSighting sighting = view.recorded(60, 290);
  EXPECT_NEAR(sighting.px.a.x(), 59.0, 0.1);  // of a detector that ends a pixel short
  EXPECT_NEAR(sighting.px.b.x(), 291.0, 0.1);
}

TEST(KeyframeRecorder, AWallInHalfTheLightGoesOn) {
  OneLine view;
  view.paint(0, 180, 100, 200);
  view.paint(180, 320, 100, 110);
  EXPECT_NEAR(view.recorded(60, 290).px.b.x(), 291.0, 0.1);
}

TEST(KeyframeRecorder, TheThinFarEndOfAStripeBelongsToIt) {
  OneLine view;
  view.paint(60, 200, 12, 235);
  view.paint(200, 290, 1, 235);
  EXPECT_NEAR(view.recorded(60, 290).px.b.x(), 291.0, 0.1);
}

}  // namespace
}  // namespace vismem
