// What a drive keeps for its map. Tests B6.
#include "mapper/core/drive_collector.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "localization/core/observation/floor_observation.h"

namespace vismem {
namespace {

using testing::IsEmpty;

MemorySegment segmentAt(std::uint64_t id, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        StampUs seen_us) {
  MemorySegment segment;
  segment.id = id;
  segment.odom = {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}};
  segment.label = "skirting";
  segment.confirmed = true;
  segment.last_seen_us = seen_us;
  return segment;
}

/// The robot stands at (10, 0) among walls near and far.
MemoryUpdate updateAt(StampUs stamp_us) {
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = stamp_us;
  snapshot->revision = static_cast<std::uint64_t>(stamp_us);
  snapshot->T_odom_robot = {10.0, 0.0, 0.3};
  const StampUs long_ago = stamp_us - 30 * kSecondUs;
  snapshot->segments = {
      segmentAt(1, {9.0, 1.0}, {11.0, 1.0}, stamp_us), segmentAt(2, {-20.0, 1.0}, {-10.0, 1.0}, long_ago),
      segmentAt(3, {-20.0, -1.0}, {30.0, -1.0}, long_ago), segmentAt(4, {16.0, 9.0}, {17.0, 9.0}, stamp_us)};
  snapshot->primitives.resize(3);
  auto analysis = std::make_shared<ImageAnalysis>();
  analysis->stamp_us = stamp_us;
  analysis->frame_seq = static_cast<std::uint64_t>(stamp_us);
  analysis->T_odom_robot = snapshot->T_odom_robot;
  analysis->predicted.resize(2);
  return {snapshot, analysis};
}

TEST(DriveCollector, RacesSeeTheSameOfTheShortenedUpdates) {
  const MemoryUpdate whole = updateAt(100 * kSecondUs);
  const MemoryUpdate part = searchedPart(whole, ObservationParams{}.range_m);
  std::vector<std::uint64_t> ids;
  for (const MemorySegment& segment : part.snapshot->segments) ids.push_back(segment.id);
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{1, 3, 4})) << "the far wall is not looked at";
  EXPECT_THAT(part.snapshot->primitives, IsEmpty());
  EXPECT_THAT(part.analysis->predicted, IsEmpty());
  SegmentMap map;
  map.segments.push_back({{{0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}}, "skirting"});
  const MapIndex index(map, {});
  const FloorObservation all = observeMemory(*whole.snapshot, index, {});
  const FloorObservation some = observeMemory(*part.snapshot, index, {});
  ASSERT_EQ(all.points.size(), some.points.size());
  ASSERT_GT(all.points.size(), 10U);
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    EXPECT_EQ(all.points[i].p_robot, some.points[i].p_robot);
    EXPECT_EQ(all.points[i].weight, some.points[i].weight);
    EXPECT_EQ(all.points[i].sigma_m, some.points[i].sigma_m);
  }
}

/// The robot at (10, 0) looks ahead and matches element 5, which it predicts from (12, 1) to (13.5, 1).
std::shared_ptr<ImageAnalysis> viewAhead(const ImageAnalysis& before) {
  auto analysis = std::make_shared<ImageAnalysis>(before);
  analysis->T_odom_robot = {10.0, 0.0, 0.0};
  analysis->intrinsics.width = 320;
  analysis->intrinsics.height = 240;
  analysis->intrinsics.fx = analysis->intrinsics.fy = 200.0;
  analysis->intrinsics.cx = 159.5;
  analysis->intrinsics.cy = 119.5;
  // 0.5 m above the robot, looking ahead: u = cx - fx y / x, v = cy + fy 0.5 / x. Shown from 2 to 3.5 m.
  analysis->T_robot_camera = Pose3::Identity();
  analysis->T_robot_camera.translation().z() = 0.5;
  analysis->T_robot_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const auto pixelOf = [&](double x) { return Eigen::Vector2d(159.5 - 200.0 / x, 119.5 + 100.0 / x); };
  analysis->predicted = {{5, {pixelOf(2.0), pixelOf(3.5)}, "skirting"}};
  analysis->observed.resize(1);
  analysis->matches = {{0, 0}};
  return analysis;
}

// A line from (11, 1) to (14, 1) is published in two parts, since another one joins it at 12.5.
TEST(PublishedElements, AnElementThatIsPublishedInPartsIsWhole) {
  const MemoryUpdate update = updateAt(100 * kSecondUs);
  auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
  snapshot->T_odom_robot = {10.0, 0.0, 0.0};
  snapshot->segments = {segmentAt(70, {11.0, 1.0}, {12.46, 1.0}, snapshot->stamp_us),
                        segmentAt(71, {12.54, 1.0}, {14.0, 1.0}, snapshot->stamp_us),
                        segmentAt(72, {14.5, 1.0}, {16.0, 1.0}, snapshot->stamp_us),
                        segmentAt(73, {14.0, 1.08}, {11.0, 1.08}, snapshot->stamp_us)};
  const auto analysis = viewAhead(*update.analysis);
  const auto elementFive = [&] {
    const std::vector<MemorySegment> elements = PublishedElements().of({snapshot, analysis});
    EXPECT_EQ(elements.size(), snapshot->segments.size() + 1);
    EXPECT_EQ(elements.back().id, 5U);
    return elements.back();
  };
  const MemorySegment whole = elementFive();
  EXPECT_TRUE(whole.confirmed);
  EXPECT_EQ(whole.last_seen_us, snapshot->stamp_us);
  EXPECT_NEAR(whole.odom.a.x(), 11.0, 1e-6);
  EXPECT_NEAR(whole.odom.b.x(), 14.0, 1e-6) << "the one behind the gap is another";
  EXPECT_NEAR(whole.odom.a.y(), 1.0, 1e-6);
  // Of the 1.5 m that are predicted, .46 m lie on the first part.
  snapshot->segments[1].confirmed = false;
  EXPECT_FALSE(elementFive().confirmed);
  // One that is published with its own id is as published.
  snapshot->segments[0].id = 5;
  EXPECT_EQ(PublishedElements().of({snapshot, analysis}).size(), snapshot->segments.size());
}

// The memory predicts what it has in view: what it predicts no more it has refuted.
TEST(PublishedElements, AnElementInPartsIsThereUntilAnImageOfItsPlaceLacksIt) {
  const MemoryUpdate update = updateAt(100 * kSecondUs);
  auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
  snapshot->T_odom_robot = {10.0, 0.0, 0.0};
  snapshot->segments = {segmentAt(70, {11.0, 1.0}, {12.46, 1.0}, snapshot->stamp_us),
                        segmentAt(71, {12.54, 1.0}, {14.0, 1.0}, snapshot->stamp_us)};
  const auto seen = viewAhead(*update.analysis);
  PublishedElements elements;
  ASSERT_EQ(elements.of({snapshot, seen}).size(), 3U);

  auto later = std::make_shared<MemorySnapshot>(*snapshot);
  later->stamp_us += kSecondUs;
  auto unmatched = std::make_shared<ImageAnalysis>(*seen);
  unmatched->matches.clear();
  const std::vector<MemorySegment> still = elements.of({later, unmatched});
  ASSERT_EQ(still.size(), 3U);
  EXPECT_EQ(still.back().id, 5U);
  EXPECT_EQ(still.back().last_seen_us, snapshot->stamp_us);

  auto away = std::make_shared<ImageAnalysis>(*unmatched);
  away->predicted.clear();
  auto refuted = std::make_shared<ImageAnalysis>(*away);
  away->T_odom_robot.theta = 1.5;
  EXPECT_EQ(elements.of({later, away}).size(), 3U) << "another place is in view";
  EXPECT_EQ(elements.of({later, refuted}).size(), 2U);
  EXPECT_EQ(elements.of({later, away}).size(), 2U) << "it is gone for ever";
}

TEST(PublishedElements, AMemoryThatBeganAnewHasNoElementsOfBefore) {
  const MemoryUpdate update = updateAt(100 * kSecondUs);
  auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
  snapshot->T_odom_robot = {10.0, 0.0, 0.0};
  snapshot->segments = {segmentAt(70, {11.0, 1.0}, {14.0, 1.0}, snapshot->stamp_us)};
  const auto seen = viewAhead(*update.analysis);
  PublishedElements elements;
  ASSERT_EQ(elements.of({snapshot, seen}).size(), 2U);
  auto anew = std::make_shared<MemorySnapshot>(*snapshot);
  ++anew->epoch;
  auto away = std::make_shared<ImageAnalysis>(*seen);
  away->matches.clear();
  EXPECT_EQ(elements.of({anew, away}).size(), 1U);
}

TEST(DriveCollector, KeepsUpdatesAtTheRateOfLocalization) {
  DriveCollector drive(KeyframeParams{}, 5.0);
  for (int i = 0; i <= 30; ++i) {
    const MemoryUpdate update = updateAt(100 * kSecondUs + i * kSecondUs / 30);
    Frame frame;
    frame.stamp_us = update.analysis->stamp_us;
    drive.add(frame, update, update.snapshot->segments);
  }
  EXPECT_EQ(drive.updates().size(), 6U);
}

TEST(DriveCollector, NothingIsKeptBehindAJumpOfTheOdometry) {
  DriveCollector drive(KeyframeParams{}, 5.0);
  for (const double x : {0.0, 0.1, 5.0, 5.1}) {
    const StampUs stamp_us = (100 + static_cast<StampUs>(2 * drive.updates().size())) * kSecondUs / 2;
    MemoryUpdate update = updateAt(stamp_us);
    auto analysis = std::make_shared<ImageAnalysis>(*update.analysis);
    analysis->T_odom_robot = {x, 0.0, 0.0};
    Frame frame;
    frame.stamp_us = stamp_us;
    drive.add(frame, {update.snapshot, analysis}, update.snapshot->segments);
  }
  EXPECT_TRUE(drive.isBroken());
  EXPECT_EQ(drive.updates().size(), 2U);
}

}  // namespace
}  // namespace vismem
