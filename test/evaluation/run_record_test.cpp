#include "evaluation/report/run_record.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(SourceRate, CountsWhatWasMadeInTheSourcesTime) {
  // Numbers 10, 11, 15 within half a second: 5 made in 0.5 s.
  SourceRate rate;
  EXPECT_EQ(rate.hz(), 0.0);
  rate.add(10, 0);
  rate.add(11, 100'000);
  rate.add(15, 500'000);
  rate.add(15, 500'000);
  EXPECT_DOUBLE_EQ(rate.hz(), 10.0);
  EXPECT_DOUBLE_EQ(rate.recentHz(500'000), 10.0);
}

TEST(SourceRate, BeginsAnewAfterARestart) {
  // 10 in 1 s, then the source restarts and makes 5 in 1 s.
  SourceRate rate;
  rate.add(0, 10 * kSecondUs);
  rate.add(10, 11 * kSecondUs);
  rate.add(0, 0);
  rate.add(5, kSecondUs);
  EXPECT_DOUBLE_EQ(rate.hz(), 7.5);
  EXPECT_DOUBLE_EQ(rate.recentHz(kSecondUs), 5.0);
}

TEST(SourceRate, ForgetsOldSamplesForTheRecentRate) {
  SourceRate rate;
  for (int i = 0; i <= 100; ++i) rate.add(i, i * 100'000);                    // 10 Hz
  for (int i = 1; i <= 100; ++i) rate.add(100 + i, 10'000'000 + i * 50'000);  // 20 Hz
  EXPECT_NEAR(rate.recentHz(15 * kSecondUs), 20.0, 1e-9);
  EXPECT_NEAR(rate.hz(), 200.0 / 15.0, 1e-9);
}

// As of a component that hangs while the robot goes on.
TEST(SourceRate, AStandingSourceHasNoRecentRate) {
  SourceRate rate;
  for (int i = 0; i <= 30; ++i) rate.add(i, i * 100'000);  // 10 Hz until 3 s
  EXPECT_NEAR(rate.recentHz(5 * kSecondUs), 10.0, 1e-9);
  EXPECT_EQ(rate.recentHz(5 * kSecondUs + 1), 0.0);
  EXPECT_NEAR(rate.hz(), 10.0, 1e-9);
}

TEST(ImageRange, CountsFromOne) {
  const ImageRange range{40, 138};
  EXPECT_FALSE(range.contains(38));
  EXPECT_TRUE(range.contains(39)) << "the image of number 40";
  EXPECT_TRUE(range.contains(137));
  EXPECT_FALSE(range.contains(138));
  EXPECT_TRUE(range.isPast(138));
  EXPECT_TRUE(ImageRange{}.contains(0));
}

/// One metre along x in ten seconds; odometry begins at another place, turned by a quarter; perfect
/// estimates.
RunRecord straightRun() {
  RunRecord record;
  const Pose2 T_world_odom{2.0, 3.0, degToRad(90.0)};
  for (int i = 0; i <= 100; ++i) {
    const StampUs t = i * 100'000;
    const Pose2 pose{0.01 * i, 0.0, 0.0};
    append(record.truth, {t, pose});
    append(record.odometry, {t, inverse(T_world_odom) * pose});
    PoseEstimate estimate;
    estimate.stamp_us = t;
    estimate.revision = i + 1;
    estimate.T_world_robot = pose;
    estimate.T_odom_robot = inverse(T_world_odom) * pose;
    record.estimates.push_back(estimate);
    record.published.push_back({t, pose, 0.0});
    record.camera.add(3 * i, t);
    record.iterations.add(i, t);
  }
  MemorySnapshot memory;
  memory.stamp_us = 10 * kSecondUs;
  // One metre ahead of odom's origin: in world one metre up from (2, 3).
  memory.segments.push_back({.id = 1, .odom = {{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}, .label = "line"});
  record.memory = std::make_shared<MemorySnapshot>(memory);
  record.shown_memory = record.memory;
  return record;
}

TEST(RunRecorder, KeepsADayInBoundedMemory) {
  RunRecorder recorder;
  const int kCount = 24 * 3600 * 20;
  for (int i = 0; i < kCount; ++i) {
    const StampUs t = i * 50'000LL;
    const Pose2 pose{0.001 * i, 0.0, 0.0};
    recorder.addTruth({t, pose});
    recorder.addOdometry({t, pose});
    // One metre off for the last hour.
    const double off_m = i < kCount - 72'000 ? 0.0 : 1.0;
    recorder.addPublished({t, Pose2{pose.x, off_m, 0.0}, 1.0});
    PoseEstimate estimate;
    estimate.stamp_us = t;
    recorder.addEstimate(estimate);
  }
  const RunRecord& record = recorder.record();
  EXPECT_LE(record.truth.size(), 1u << 20);
  EXPECT_LE(record.odometry.size() + record.published.size(), 2u << 18);
  EXPECT_LE(record.estimates.size(), 1u << 16);
  EXPECT_EQ(record.estimates.back().stamp_us, (kCount - 1) * 50'000LL) << "the newest is kept";
  const RunSummary summary = summarize(record, {});
  EXPECT_NEAR(summary.seconds, (kCount - 1) * 0.05, 1e-6);
  EXPECT_NEAR(summary.distance_m, (kCount - 1) * 0.001, 1e-3);
  EXPECT_NEAR(summary.score.settled_after_s.value(), 0.0, 1e-9);
  EXPECT_NEAR(summary.score.right_share.value(), 23.0 / 24.0, 1e-3);
  EXPECT_NEAR(summary.score.position_error_m.value(), 1.0 / 24.0, 1e-3);
  EXPECT_FALSE(summary.score.recovered) << "wrong at the end";
}

TEST(RunRecorder, LeavesOutWhatIsNotNewer) {
  RunRecorder recorder;
  for (const StampUs t : {0, 2, 1, 2, 3}) recorder.addOdometry({t, {}});
  EXPECT_EQ(recorder.record().odometry.size(), 3u);
}

TEST(RunRecord, IsSummarized) {
  const RunSummary summary = summarize(straightRun(), {});
  EXPECT_NEAR(summary.seconds, 10.0, 1e-9);
  EXPECT_NEAR(summary.distance_m, 1.0, 1e-9);
  EXPECT_NEAR(summary.camera_hz, 30.0, 1e-9);
  EXPECT_NEAR(summary.memory_hz, 10.0, 1e-9);
  EXPECT_EQ(summary.memory_segments, 1);
  EXPECT_NEAR(summary.score.settled_after_s.value(), 0.0, 1e-9);
  EXPECT_NEAR(summary.score.position_error_m.value(), 0.0, 1e-9);
  EXPECT_FALSE(summary.projection);
}

TEST(RunRecord, CarriesOdometryAndMemoryIntoWorld) {
  const RunRecord record = straightRun();
  const TopView view = topViewOf(record, summarize(record, {}), {}, "title");
  ASSERT_EQ(view.odometry.size(), 101u);
  EXPECT_NEAR(view.odometry.back().pose.x, 1.0, 1e-9) << "from the true start";
  EXPECT_NEAR(view.odometry.back().pose.y, 0.0, 1e-9);
  ASSERT_EQ(view.memory.size(), 1u);
  EXPECT_NEAR(view.memory[0].world.a.x(), 2.0, 1e-9);
  EXPECT_NEAR(view.memory[0].world.a.y(), 4.0, 1e-9);
  EXPECT_NEAR(view.robot.value().x, 1.0, 1e-9);
}

// The memory moves all its elements with the drift, so the present pose places them, whenever they were seen.
TEST(RunRecord, PlacesTheWholeMemoryByThePresentPose) {
  RunRecord record = straightRun();
  const Pose2 T_world_odom_first{2.0, 3.0, degToRad(90.0)};
  // Odometry drifts: in the end odom lies 0.4 m and 2 degrees from where it lay at the start.
  const Pose2 T_world_odom_last{2.4, 3.0, degToRad(92.0)};
  for (PoseEstimate& e : record.estimates) {
    const double share = toSeconds(e.stamp_us) / 10.0;
    e.T_odom_robot = inverse(interpolate(T_world_odom_first, T_world_odom_last, share)) * *e.T_world_robot;
  }
  const Segment3 true_line{{2.0, 4.0, 0.0}, {2.0, 5.0, 0.0}};
  MemorySnapshot memory = *record.memory;
  memory.T_odom_robot = record.estimates.back().T_odom_robot;
  memory.segments[0].odom = transform(inverse(T_world_odom_last), true_line);
  memory.segments.push_back(memory.segments[0]);
  memory.segments[0].last_seen_us = kSecondUs;
  memory.segments[1].last_seen_us = memory.stamp_us;
  record.memory = record.shown_memory = std::make_shared<MemorySnapshot>(memory);
  const TopView view = topViewOf(record, summarize(record, {}), {}, "title");
  ASSERT_EQ(view.memory.size(), 2u);
  for (const LabelledSegment& segment : view.memory) {
    EXPECT_LT((segment.world.a - true_line.a).norm(), 1e-9) << segment.unseen_us;
    EXPECT_LT((segment.world.b - true_line.b).norm(), 1e-9) << segment.unseen_us;
  }
}

TEST(RunRecord, ShowsNoMemoryWithoutAPose) {
  RunRecord record = straightRun();
  for (PoseEstimate& e : record.estimates) e.T_world_robot.reset();
  EXPECT_TRUE(topViewOf(record, summarize(record, {}), {}, "title").memory.empty());
}

TEST(RunRecord, ShowsNothingPastTheShownMemory) {
  RunRecord record = straightRun();
  MemorySnapshot earlier = *record.memory;
  earlier.stamp_us = 4 * kSecondUs;
  record.shown_memory = std::make_shared<MemorySnapshot>(earlier);
  const TopView view = topViewOf(record, summarize(record, {}), {}, "title");
  EXPECT_EQ(view.estimate.back().stamp_us, 4 * kSecondUs);
  EXPECT_NEAR(view.robot.value().x, 0.4, 1e-9);
  EXPECT_NEAR(view.true_robot.value().x, 0.4, 1e-9);
}

TEST(RunRecord, JudgesTheProjectionOfTheKeptImages) {
  // A camera that looks straight down from 1 m with f = 100 px, and a pose that is 3 cm beside the line.
  ImageAnalysis analysis;
  analysis.stamp_us = 5 * kSecondUs;
  analysis.intrinsics = {.width = 320, .height = 240, .fx = 100, .fy = 100, .cx = 160, .cy = 120};
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  analysis.T_robot_camera.linear() = R;
  analysis.T_robot_camera.translation() << 0.0, 0.0, 1.0;
  // The line y = 0 lies in the column u = 160.
  analysis.observed.push_back({{{160, 10}, {160, 200}}, "line", 50.0});
  RunRecord record;
  record.analyses.push_back(std::make_shared<ImageAnalysis>(analysis));
  PoseEstimate estimate;
  estimate.stamp_us = analysis.stamp_us;
  estimate.T_world_robot = Pose2{0.0, 0.03, 0.0};
  record.estimates.push_back(estimate);
  SegmentMap map;
  map.segments.push_back({{{-5, 0, 0}, {5, 0, 0}}, "line", 0.0});
  const RunSummary summary = summarize(record, map, true);
  ASSERT_TRUE(summary.projection);
  EXPECT_EQ(summary.projection->images, 1);
  EXPECT_NEAR(summary.projection->detected_to_map_px.value(), 3.0, 1e-6);
}

}  // namespace
}  // namespace vismem
