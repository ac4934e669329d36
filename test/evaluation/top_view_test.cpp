#include "evaluation/figures/top_view.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"
#include "support/picture_probe.h"

namespace vismem {
namespace {

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

TEST(TopView, DashesWhatIsNotConfirmedToLieOnTheFloor) {
  // As the outline of a corner that stands upright: on the floor it crosses the free ring.
  TopView view = corridorView();
  view.memory.push_back({{{8.0, 3.3, 0}, {9.5, 3.3, 0}}, "skirting"});
  const auto paperAlong = [&] {
    const cv::Mat picture = drawTopView(view);
    const TopViewFrame frame = topViewFrame(view);
    int paper = 0;
    for (double x = 8.15; x < 9.35; x += 0.01)
      paper += distanceTo(picture, frame.toPx({x, 3.3}), colors::kPaper, 0) < 20 ? 1 : 0;
    return paper;
  };
  EXPECT_EQ(paperAlong(), 0);
  view.memory.back().confirmed = false;
  EXPECT_GT(paperAlong(), 20) << "gaps between the dashes";
}

TEST(MemoryInWorld, PlacesAllSegmentsByOneTransformWheneverTheyWereSeen) {
  MemorySnapshot memory;
  memory.stamp_us = 10 * kSecondUs;
  for (const StampUs last_seen_us : {StampUs{4 * kSecondUs}, StampUs{10 * kSecondUs}}) {
    memory.segments.push_back(
        {.odom = {{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}, .label = "line", .last_seen_us = last_seen_us});
  }
  // odom's x axis is world's y axis.
  const auto placed = memoryInWorld(memory, {5.0, 5.0, degToRad(90.0)});
  ASSERT_EQ(placed.size(), 2u);
  for (const LabelledSegment& segment : placed) {
    EXPECT_NEAR(segment.world.a.x(), 5.0, 1e-12);
    EXPECT_NEAR(segment.world.a.y(), 6.0, 1e-12);
    EXPECT_NEAR(segment.world.b.y(), 7.0, 1e-12);
  }
  EXPECT_EQ(placed[0].unseen_us, 6 * kSecondUs);
  EXPECT_EQ(placed[1].unseen_us, 0);
}

}  // namespace
}  // namespace vismem
