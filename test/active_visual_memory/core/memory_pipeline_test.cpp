// Tests M1, M3.
#include "active_visual_memory/core/memory_pipeline.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kHeight_m = 0.45;

/// A white rectangle of 0.6 x 0.4 m on a dark floor, 1.0 m ahead: drawn by asking every pixel where it looks.
RobotObservation observe(StampUs stamp_us, double pan_rad) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, kHeight_m, 0, 0, 0);
  RobotObservation o;
  o.frame.stamp_us = stamp_us;
  o.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  o.pan_tilt = PanTilt{pan_rad, degToRad(-20.0)};
  o.T_robot_camera = cameraPose(mount, pan_rad, degToRad(-20.0));
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      int inside = 0;  // of 16 samples: an anti-aliased edge
      for (int s = 0; s < 16; ++s) {
        const Eigen::Vector2d px{u + (s % 4 - 1.5) / 4, v + (s / 4 - 1.5) / 4};
        const auto p = backProjectToGround(o.frame.intrinsics, o.T_robot_camera, px, 50.0);
        inside += p && p->x() > 1.0 && p->x() < 1.6 && p->y() > -0.2 && p->y() < 0.2;
      }
      const auto grey = static_cast<unsigned char>(60 + 150 * inside / 16);
      image.at<cv::Vec3b>(v, u) = {grey, grey, grey};
    }
  }
  o.frame.image = image;
  return o;
}

TEST(MemoryPipeline, RemembersARectangleFromItsImage) {
  MemoryPipelineParams params = MemoryPipelineParams::standard();
  params.memory.gaze.initial_mode = GazeMode::kOff;
  MemoryPipeline pipeline(params, nullptr);
  AttentiveVisualMemory::StepResult result;
  for (int i = 0; i < 8; ++i) result = pipeline.process(observe(i * 33'333, degToRad(i - 4.0)));
  const auto& segments = result.update.snapshot->segments;
  ASSERT_EQ(segments.size(), 4u);
  const std::vector<Segment2> sides{{{1.0, -0.2}, {1.0, 0.2}},
                                    {{1.6, -0.2}, {1.6, 0.2}},
                                    {{1.0, -0.2}, {1.6, -0.2}},
                                    {{1.0, 0.2}, {1.6, 0.2}}};
  for (const Segment2& side : sides) {
    double best = 1.0;
    for (const MemorySegment& s : segments) {
      const Segment2 floor = s.odom.floor();
      const double same = std::max((floor.a - side.a).norm(), (floor.b - side.b).norm());
      const double turned = std::max((floor.a - side.b).norm(), (floor.b - side.a).norm());
      best = std::min({best, same, turned});
    }
    // At 1.6 m a pixel is 2 cm of floor along the ray, and corners are blurred over some of them.
    EXPECT_LT(best, 0.04);
  }
  // The inside is brighter: it lies to the left of every remembered a -> b.
  for (const MemorySegment& s : segments) {
    const Eigen::Vector2d d = s.odom.floor().b - s.odom.floor().a;
    const Eigen::Vector2d to_middle = Eigen::Vector2d(1.3, 0.0) - s.odom.floor().middle();
    EXPECT_GT(d.x() * to_middle.y() - d.y() * to_middle.x(), 0.0);
  }
}

TEST(MemoryPipeline, FineImagesAreAveragedAndResultsStateTheirLens) {
  MemoryPipeline pipeline(MemoryPipelineParams::standard(), nullptr);
  RobotObservation fine = observe(0, 0.0);
  cv::Mat enlarged;
  cv::resize(fine.frame.image, enlarged, {1280, 960}, 0, 0, cv::INTER_LINEAR);
  fine.frame.image = enlarged;
  fine.frame.intrinsics = intrinsicsFromFieldOfView(1280, 960, degToRad(60.0));
  const auto result = pipeline.process(fine);
  const ImageAnalysis& analysis = *result.update.analysis;
  EXPECT_EQ(analysis.intrinsics.width, 640);
  EXPECT_EQ(analysis.observed.size(), 4u);
  for (const ImageSegment& segment : analysis.observed) {
    const auto p = backProjectToGround(analysis.intrinsics, analysis.T_robot_camera, segment.px.middle(), 50.0);
    ASSERT_TRUE(p);
    const double off = std::min({std::abs(p->x() - 1.0), std::abs(p->x() - 1.6), std::abs(std::abs(p->y()) - 0.2)});
    EXPECT_LT(off, 0.02);
  }
  fine.frame.image = observe(0, 0.0).frame.image;
  fine.frame.stamp_us = kSecondUs;
  EXPECT_THROW(pipeline.process(fine), std::invalid_argument);
}

}  // namespace
}  // namespace vismem
