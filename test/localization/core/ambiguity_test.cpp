// Tests L12: unobservable directions and indistinguishable places keep their uncertainty.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/geometry/angles.h"
#include "localization/core/localizer.h"

namespace vismem {
namespace {

constexpr double kPeriod_s = 0.1;

MapSegment edge(double x1, double y1, double x2, double y2, const Label& label) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

/// A memory with given edges, all just seen, without images.
class PerfectMemory {
 public:
  MemoryUpdate next(const Pose2& T_odom_robot, const std::vector<Segment2>& odom,
                    const std::vector<Label>& labels) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    stamp_us_ += static_cast<StampUs>(kPeriod_s * kSecondUs);
    snapshot->stamp_us = stamp_us_;
    snapshot->revision = ++revision_;
    snapshot->T_odom_robot = T_odom_robot;
    for (std::size_t i = 0; i < odom.size(); ++i) {
      MemorySegment segment;
      segment.id = i + 1;
      segment.odom = {{odom[i].a.x(), odom[i].a.y(), 0.0}, {odom[i].b.x(), odom[i].b.y(), 0.0}};
      segment.label = labels[i];
      segment.confirmed = true;
      segment.first_seen_us = segment.last_seen_us = stamp_us_;
      snapshot->segments.push_back(segment);
    }
    auto analysis = std::make_shared<ImageAnalysis>();
    analysis->stamp_us = stamp_us_;
    analysis->T_odom_robot = T_odom_robot;
    return {snapshot, analysis};
  }

 private:
  StampUs stamp_us_ = kSecondUs;
  std::uint64_t revision_ = 0;
};

TEST(Ambiguity, UncertaintyAlongTheOnlyLineGrowsWithTheDistance) {
  SegmentMap map;
  map.segments = {edge(-60, 0, 60, 0, "skirting")};
  LocalizerParams params = localizerPreset(LocalizationMode::kDefault);
  params.robust.filter.odometry.share = 0.1;
  params.robust.filter.walk_m = 0.01;
  Localizer localizer(params, map, 1);
  PerfectMemory memory;
  const Pose2 start{-20.0, -1.0, 0.0};
  const auto drive = [&](double x_m) {
    const Pose2 T_odom_robot{x_m, 0.0, 0.0};
    return localizer.update(memory.next(T_odom_robot, {{{x_m - 2.0, 1.0}, {x_m + 2.0, 1.0}}}, {"skirting"}));
  };
  drive(0.0);
  localizer.setPose(start);
  double std_along_m = 0.0;
  for (int second = 1; second <= 30; ++second) {
    PoseEstimate estimate;
    for (int i = 0; i < 10; ++i) estimate = drive(0.3 * (second - 1) + 0.03 * (i + 1));
    const double now_m = std::sqrt(estimate.P(0, 0));
    EXPECT_GT(now_m, std_along_m) << "after " << second << " s";
    std_along_m = now_m;
    ASSERT_TRUE(estimate.T_world_robot);
    EXPECT_NEAR(estimate.T_world_robot->x, start.x + 0.3 * second, 0.05) << "by odometry alone";
    EXPECT_NEAR(estimate.T_world_robot->y, start.y, 0.03);
    EXPECT_LT(std::sqrt(estimate.P(1, 1)), 0.05);
  }
  EXPECT_GT(std_along_m, 0.15) << "9 m by an odometry of 10 %, in independent steps";
}

/// Two equal rooms 20 m apart, each 4 x 3 m with one door.
class TwinRooms : public testing::Test {
 protected:
  static constexpr double kApart_m = 20.0;
  static SegmentMap map() {
    SegmentMap map;
    for (const double x : {0.0, kApart_m}) {
      const auto room = edges(x);
      map.segments.insert(map.segments.end(), room.begin(), room.end());
    }
    return map;
  }
  static std::vector<MapSegment> edges(double x) {
    return {edge(x, 0, x + 2.5, 0, "skirting"),     edge(x + 2.5, 0, x + 3.4, 0, "door_foot"),
            edge(x + 3.4, 0, x + 4, 0, "skirting"), edge(x + 4, 0, x + 4, 3, "skirting"),
            edge(x + 4, 3, x, 3, "skirting"),       edge(x, 3, x, 0, "skirting")};
  }
  /// An update with all edges of the room.
  PoseEstimate look(Localizer& localizer) {
    std::vector<Segment2> odom;
    std::vector<Label> labels;
    for (const MapSegment& one : edges(0.0)) {
      odom.push_back(transform(inverse(kInRoom), one.world.floor()));
      labels.push_back(one.label);
    }
    return localizer.update(memory_.next({}, odom, labels));
  }
  static double belief(const PoseEstimate& estimate, double x_of_room) {
    double sum = 0.0;
    for (const RaceReport& race : estimate.races) {
      const bool here =
          std::hypot(race.T_world_robot.x - kInRoom.x - x_of_room, race.T_world_robot.y - kInRoom.y) < 0.3 &&
          std::abs(angleDifference(race.T_world_robot.theta, kInRoom.theta)) < degToRad(15);
      if (here) sum += race.weight;
    }
    return sum;
  }

  static constexpr Pose2 kInRoom{1.5, 1.2, 0.6};
  PerfectMemory memory_;
};

TEST_F(TwinRooms, ShareTheBelief) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Localizer localizer(localizerPreset(LocalizationMode::kDefault), map(), seed);
    PoseEstimate estimate;
    for (int i = 0; i < 300; ++i) {
      estimate = look(localizer);
      // After 10 s.
      if (i < 100) continue;
      EXPECT_GT(belief(estimate, 0.0), 0.3) << "seed " << seed << ", image " << i;
      EXPECT_GT(belief(estimate, kApart_m), 0.3) << "seed " << seed << ", image " << i;
    }
    EXPECT_LT(estimate.reliability, 0.7) << "half of the belief lies elsewhere";
  }
}

}  // namespace
}  // namespace vismem
