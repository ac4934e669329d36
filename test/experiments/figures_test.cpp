#include "experiments/core/figures.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "experiments/core/canvas.h"

namespace vismem {
namespace {

/// With FIGURES_OUT=DIR the pictures are kept there, for the eye.
void keep(const cv::Mat& rgb, const std::string& name) {
  const char* folder = std::getenv("FIGURES_OUT");
  if (folder == nullptr) return;
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  cv::imwrite((std::filesystem::path(folder) / name).string(), bgr);
}

/// Largest difference of a channel between a colour and the nearest pixel around a place.
int distanceTo(const cv::Mat& picture, const Eigen::Vector2d& px, Rgb color, int radius = 1) {
  int best = 255;
  for (int dv = -radius; dv <= radius; ++dv) {
    for (int du = -radius; du <= radius; ++du) {
      const cv::Point at(static_cast<int>(px.x()) + du, static_cast<int>(px.y()) + dv);
      if (!cv::Rect(0, 0, picture.cols, picture.rows).contains(at)) continue;
      const auto& p = picture.at<cv::Vec3b>(at);
      best = std::min(
          best, std::max({std::abs(p[0] - color.r), std::abs(p[1] - color.g), std::abs(p[2] - color.b)}));
    }
  }
  return best;
}

MapSegment wall(double x1, double y1, double x2, double y2, const char* label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

TopView corridorView() {
  TopView view;
  view.title = "corridor, seed 7";
  view.subtitle = "60.0 s, settled after 12.4 s, mean error 0.084 m and 1.9 deg";
  for (const double inset : {0.0, 1.5}) {
    const double x0 = inset, x1 = 9.5 - inset, y0 = inset, y1 = 6.5 - inset;
    view.map.segments.push_back(wall(x0, y0, x1, y0));
    view.map.segments.push_back(wall(x1, y0, x1, y1));
    view.map.segments.push_back(wall(x1, y1, x0, y1));
    view.map.segments.push_back(wall(x0, y1, x0, y0));
  }
  view.map.segments.push_back(wall(3.0, 0.0, 3.9, 0.0, "door"));
  view.map.segments.push_back(wall(9.5, 2.0, 9.5, 2.8, "door"));
  for (int i = 0; i <= 300; ++i) {
    const double s = i / 300.0;
    const Pose2 pose =
        s < 0.6 ? Pose2{1.0 + 12.0 * s, 0.75, 0.0} : Pose2{8.75, 0.75 + 10.0 * (s - 0.6), degToRad(90)};
    const StampUs t = i * 200'000;
    append(view.truth, {t, pose});
    append(view.odometry, {t, Pose2{pose.x + 0.1 * s, pose.y + 0.5 * s * s, pose.theta}});
    append(view.estimate,
           {t, i < 60 ? Pose2{1.0 + i % 7, 5.7, 1.0} : Pose2{pose.x + 0.05, pose.y - 0.05, pose.theta}});
  }
  view.settled_us = 60 * 200'000;
  view.memory.push_back({{{9.47, 1.0, 0}, {9.52, 4.4, 0}}, "skirting"});
  view.memory.push_back({{{8.03, 1.6, 0}, {7.98, 4.6, 0}}, "skirting"});
  view.memory.push_back({{{6.0, 0.04, 0}, {9.3, 0.02, 0}}, "skirting"});
  view.robot = view.estimate.back().pose;
  view.true_robot = view.truth.back().pose;
  view.races.push_back({1, *view.robot, 0.9, 0.8, 10, 100, true});
  view.races.push_back({2, {0.75, 3.0, -1.57}, 0.5, 0.2, 2, 20, false});
  view.view = ViewCone{degToRad(100), degToRad(60), 2.0};
  return view;
}

TEST(TopView, DrawsEverythingAtItsPlace) {
  const TopView view = corridorView();
  const cv::Mat picture = drawTopView(view);
  keep(picture, "top_view.png");
  const TopViewFrame frame = topViewFrame(view);
  EXPECT_LT(distanceTo(picture, frame.toPx({5.0, 6.5}), categoryColor(1)), 20)
      << "labels are sorted: skirting";
  EXPECT_LT(distanceTo(picture, frame.toPx({3.4, 0.0}), categoryColor(0)), 20) << "door";
  EXPECT_LT(distanceTo(picture, frame.toPx({7.0, 0.76}), colors::kTruth), 20);
  EXPECT_LT(distanceTo(picture, frame.toPx({8.0, 0.02}), colors::kMemory), 20);
  EXPECT_LT(distanceTo(picture, frame.toPx(view.robot->position()), colors::kEstimate), 20);
  // The estimate before settling jumps about on the upper wing: dots, and nothing joins them.
  EXPECT_LT(distanceTo(picture, frame.toPx({3.0, 5.7}), colors::kEstimate), 60);
  EXPECT_LT(distanceTo(picture, frame.toPx({3.5, 5.7}), colors::kPaper, 0), 40);
  EXPECT_GT(distanceTo(picture, frame.toPx({5.0, 3.2}), colors::kMemory), 100)
      << "nothing in the ring's middle";
}

TEST(TopView, DrawsAWorldWithoutMapOrPaths) {
  TopView view;
  view.title = "empty";
  const cv::Mat picture = drawTopView(view);
  EXPECT_GT(picture.cols, 400);
  EXPECT_GT(picture.rows, 300);
}

TEST(TopView, KeepsFarPathsOutsideThePlot) {
  TopView view = corridorView();
  append(view.estimate, {100 * kSecondUs, {500.0, 500.0, 0.0}});
  const TopViewFrame frame = topViewFrame(view);
  EXPECT_DOUBLE_EQ(frame.px_per_m, topViewFrame(corridorView()).px_per_m);
  const cv::Mat picture = drawTopView(view);
  EXPECT_EQ(distanceTo(picture, {3.0, 300.0}, colors::kPaper, 0), 0) << "the margin stays clean";
}

TEST(TopView, DrawsWhatWasNotSeenLatelyPaler) {
  TopView view = corridorView();
  view.memory[2].unseen_us = 10 * kSecondUs;
  const TopViewFrame frame = topViewFrame(view);
  const cv::Mat picture = drawTopView(view);
  EXPECT_GT(distanceTo(picture, frame.toPx({8.0, 0.02}), colors::kMemory), 60);
  EXPECT_LT(distanceTo(picture, frame.toPx({8.0, 0.02}), {233, 154, 190}), 20) << "mixed with the paper";
  EXPECT_LT(distanceTo(picture, frame.toPx({9.5, 3.4}), colors::kMemory), 20);
}

MemorySnapshot memoryOfOne(StampUs last_seen_us) {
  MemorySnapshot memory;
  memory.stamp_us = 10 * kSecondUs;
  memory.segments.push_back(
      {.id = 1, .odom = {{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}, .label = "line", .last_seen_us = last_seen_us});
  return memory;
}

TEST(CarriedMemory, MovesSegmentsIntoWorld) {
  const auto carried = carriedMemory(memoryOfOne(4 * kSecondUs), {{0, {5.0, 5.0, degToRad(90.0)}}});
  ASSERT_EQ(carried.size(), 1u);
  EXPECT_NEAR(carried[0].world.a.x(), 5.0, 1e-12);
  EXPECT_NEAR(carried[0].world.a.y(), 6.0, 1e-12);
  EXPECT_NEAR(carried[0].world.b.y(), 7.0, 1e-12);
  EXPECT_EQ(carried[0].unseen_us, 6 * kSecondUs);
  EXPECT_TRUE(carriedMemory(memoryOfOne(0), {}).empty()) << "nobody knows where";
}

TEST(CarriedMemory, PlacesEachSegmentByTheBeliefWhenItWasLastSeen) {
  // Odometry turned by a quarter between 3 s and 4 s.
  const Trajectory T_world_odom{{3 * kSecondUs, {0, 0, 0}}, {4 * kSecondUs, {0, 0, degToRad(90.0)}}};
  const auto x = [&](StampUs last_seen_us) {
    return carriedMemory(memoryOfOne(last_seen_us), T_world_odom).at(0).world.a.x();
  };
  EXPECT_NEAR(x(0), 1.0, 1e-12) << "before the first";
  EXPECT_NEAR(x(3'400'000), 1.0, 1e-12);
  EXPECT_NEAR(x(3'600'000), 0.0, 1e-12) << "the nearest, not one in between";
  EXPECT_NEAR(x(9 * kSecondUs), 0.0, 1e-12);
}

TEST(ErrorFigure, DrawsCurvesLimitsAndTheSettlingTime) {
  ErrorFigure figure;
  figure.title = "corridor, seed 7: error over time";
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.2 * i;
    PoseError e{toStampUs(t), 0.0, 0.0, 0.5};
    e.position_m = t < 12.0 ? 4.0 + std::sin(t) : 0.08 + 0.04 * std::sin(t);
    e.heading_rad = degToRad(t < 12.0 ? 120.0 : 2.0 + std::cos(2 * t));
    if (t > 4.0 && t < 5.0) e.position_m.reset(), e.heading_rad.reset();
    figure.score.errors.push_back(e);
  }
  figure.score.settled_after_s = 12.0;
  figure.score.position_error_m = 0.081;
  figure.score.heading_error_rad = degToRad(2.03);
  const cv::Mat picture = drawErrors(figure);
  keep(picture, "error.png");
  EXPECT_LT(distanceTo(picture, positionErrorPx(8.0, 60.0, 4.0 + std::sin(8.0)), colors::kEstimate), 40);
  EXPECT_LT(distanceTo(picture, headingErrorPx(8.0, 60.0, degToRad(120.0)), colors::kEstimate), 40);
  EXPECT_LT(distanceTo(picture, positionErrorPx(12.0, 60.0, 1.5), colors::kTruth), 40) << "the settling time";
  EXPECT_GT(distanceTo(picture, positionErrorPx(14.0, 60.0, 8.0), colors::kEstimate), 100);
  // Images without a pose: red at the top border, no curve.
  EXPECT_LT(distanceTo(picture, positionErrorPx(4.4, 60.0, 30.0) + Eigen::Vector2d(0, 4), colors::kLost, 2),
            60);
}

TEST(ErrorFigure, SaysWhenThereIsNothingToShow) {
  EXPECT_FALSE(drawErrors({}).empty());
}

TEST(ImageFigure, ShowsTheMapWhereThePosePutsIt) {
  ImageFigure figure;
  figure.title = "last image, t = 60.00 s";
  figure.analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  figure.analysis.T_robot_camera =
      cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-20.0));
  figure.image = cv::Mat(240, 320, CV_8UC3, cv::Scalar(140, 145, 150));
  figure.T_world_robot = Pose2{1.0, 0.75, 0.0};
  figure.map_edges = {wall(0, 0, 9, 0), wall(0, 1.5, 9, 1.5)};
  const Pose3 T_world_camera = toPose3(*figure.T_world_robot) * figure.analysis.T_robot_camera;
  const auto px = projectSegment(figure.analysis.intrinsics, T_world_camera, {{1.5, 0, 0}, {3.0, 0, 0}});
  ASSERT_TRUE(px);
  figure.analysis.observed.push_back({{{20, 30}, {90, 40}}, "unknown", 20.0});
  figure.analysis.observed.push_back({*px, "skirting", 60.0});
  figure.analysis.predicted.push_back({1, *px, "skirting"});
  figure.analysis.matches.push_back({1, 0});
  const cv::Mat picture = drawLastImage(figure);
  keep(picture, "last_image.png");
  // Pictures are enlarged twice; the right one begins at 2 * 20 + 640, 70.
  const auto place = [](const Eigen::Vector2d& at, double left) {
    return Eigen::Vector2d(left + (at.x() + 0.5) * 2.0, 70.0 + (at.y() + 0.5) * 2.0);
  };
  EXPECT_LT(distanceTo(picture, place(px->middle(), 680.0), colors::kMemory), 60) << "the map";
  EXPECT_LT(distanceTo(picture, place({55.0, 35.0}, 20.0), {50, 110, 255}), 60) << "observed only";
  EXPECT_EQ(distanceTo(picture, place({160.0, 200.0}, 680.0), {140, 145, 150}, 0), 0) << "the image itself";
  figure.T_world_robot.reset();
  EXPECT_EQ(drawLastImage(figure).cols, 680) << "without a pose there is one picture";
}

}  // namespace
}  // namespace vismem
