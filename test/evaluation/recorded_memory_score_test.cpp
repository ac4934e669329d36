// Tests E4. The memory is synthetic, drawn from the map, so that its errors are known.
#include "evaluation/core/recorded_memory_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPieces = 48;

Eigen::Vector2d onCircle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Half a field: two lines that cross, and a circle of 0.6 m painted 5 cm wide, as chords of 48 pieces.
SegmentMap field() {
  SegmentMap map;
  const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    map.segments.push_back({{{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}}, "line", 0.05});
  };
  add({0.0, -2.0}, {0.0, 2.0});
  add({-2.0, 2.0}, {2.0, 2.0});
  for (int i = 0; i < kPieces; ++i) {
    add(onCircle(0.6, 2.0 * kPi * i / kPieces), onCircle(0.6, 2.0 * kPi * (i + 1) / kPieces));
  }
  return expandStripes(map, {});
}

MemorySegment element(std::uint64_t id, const Segment2& odom, bool confirmed = true) {
  MemorySegment s;
  s.id = id;
  s.odom = {{odom.a.x(), odom.a.y(), 0.0}, {odom.b.x(), odom.b.y(), 0.0}};
  s.label = "line";
  s.confirmed = confirmed;
  return s;
}

struct MadeUp {
  double circle_factor = 1.0;  ///< of the remembered circle's radius
  double shift_m = 0.0;        ///< of the crossing line, across itself
  bool twice = false;          ///< every element has a copy
};

/// The memory of a robot at (0.5, 0.3) in world, whose odometry began elsewhere.
RecordedMoment moment(StampUs stamp_us, const Pose2& T_world_odom, const MadeUp& made) {
  const Pose2 T_world_robot{0.5, 0.3, 0.4};
  auto memory = std::make_shared<MemorySnapshot>();
  memory->stamp_us = stamp_us;
  memory->T_odom_robot = inverse(T_world_odom) * T_world_robot;
  const Pose2 T_odom_world = inverse(T_world_odom);
  std::uint64_t id = 1;
  const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    for (int copy = 0; copy < (made.twice ? 2 : 1); ++copy) {
      memory->segments.push_back(element(id++, transform(T_odom_world, Segment2{a, b})));
    }
  };
  add({-0.025 + made.shift_m, -1.5}, {-0.025 + made.shift_m, 1.5});
  add({0.025 + made.shift_m, 1.5}, {0.025 + made.shift_m, -1.5});
  add({-1.0, 1.975}, {1.0, 1.975});
  // The line is brighter than the floor, and the brighter side lies left of a -> b: outwards along the inner
  // rim, inwards along the outer one.
  for (int i = 0; i < kPieces; i += 2) {
    const double from = 2.0 * kPi * i / kPieces;
    const double to = 2.0 * kPi * (i + 2) / kPieces;
    add(onCircle(0.575 * made.circle_factor, to), onCircle(0.575 * made.circle_factor, from));
    add(onCircle(0.625 * made.circle_factor, from), onCircle(0.625 * made.circle_factor, to));
  }
  RecordedMoment moment;
  moment.memory = memory;
  moment.intrinsics = intrinsicsFromFieldOfView(320, 240, kPi / 3.0);
  // 3 m up, looking straight down: the image shows the whole field.
  moment.T_robot_camera.linear() << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  moment.T_robot_camera.translation() << 0.0, 0.0, 3.0;
  moment.T_world_robot = Pose2{0.55, 0.22, 0.45};  // localization is a little off
  return moment;
}

RecordedMemoryScore scoreOf(const MadeUp& made) {
  // Odometry drifts between the windows by more than the measured distances.
  std::vector<RecordedMoment> moments;
  for (int i = 0; i < 20; ++i) {
    const Pose2 T_world_odom = i < 10 ? Pose2{3.0, -1.0, 2.0} : Pose2{3.4, -0.8, 2.2};
    moments.push_back(moment(toStampUs(1.0 + 0.5 * i), T_world_odom, made));
  }
  return scoreRecordedMemory(moments, field());
}

TEST(RecordedMemoryScore, AMemoryThatIsRightFitsWhereverOdometryBegan) {
  const RecordedMemoryScore score = scoreOf({});
  EXPECT_EQ(score.moments, 20);
  EXPECT_EQ(score.moments_without_pose, 0);
  ASSERT_EQ(score.windows.size(), 2u);
  ASSERT_TRUE(score.distance_m);
  EXPECT_LT(*score.distance_m, 0.002);
  // Chords of twice the map's pieces lie inside the arcs by r (1 - cos 7.5 deg) = 5 mm in their middles.
  EXPECT_NEAR(score.windows[1].T_world_odom.x, 3.4, 0.003);
  EXPECT_NEAR(angleDifference(score.windows[1].T_world_odom.theta, 2.2), 0.0, 0.002);
  ASSERT_TRUE(score.circle_radius_m);
  EXPECT_NEAR(score.circle_radius_m->median, 0.6, 0.005);
  EXPECT_EQ(score.moments_with_circle, 20);
  EXPECT_EQ(score.moments_with_circle_shape, 0);
  EXPECT_NEAR(score.elements_per_edge.most, 1.0, 0.05);
}

TEST(RecordedMemoryScore, FindsACircleThatIsTooSmall) {
  const RecordedMemoryScore score = scoreOf({.circle_factor = 0.92});
  ASSERT_TRUE(score.circle_radius_m);
  EXPECT_NEAR(score.circle_radius_m->median, 0.552, 0.01);
}

TEST(RecordedMemoryScore, CountsElementsThatAreThereTwice) {
  EXPECT_NEAR(scoreOf({.twice = true}).elements_per_edge.median, 2.0, 0.1);
}

TEST(RecordedMemoryScore, OneRigidMotionDoesNotHideWhatIsWrongInsideTheMemory) {
  // The circle holds the fit back: the line's 20 cm are shared among both, and neither is right.
  std::vector<double> off;
  const RecordedMemoryScore score = scoreOf({.shift_m = 0.2});
  const auto& window = score.windows.front();
  std::vector<Segment2> map;
  for (const auto& s : field().segments) map.push_back(s.world.floor());
  const Segment2 shifted{{0.175, -1.5}, {0.175, 1.5}};
  const Pose2 T_odom_world = inverse(Pose2{3.0, -1.0, 2.0});
  appendDistances(transform(window.T_world_odom, transform(T_odom_world, shifted)), map, {}, off);
  std::sort(off.begin(), off.end());
  EXPECT_GT(off[off.size() / 2], 0.03);
}

TEST(RecordedMemoryScore, WithoutAnyPoseNothingIsJudged) {
  std::vector<RecordedMoment> moments{moment(toStampUs(1.0), {}, {})};
  moments.front().T_world_robot.reset();
  const RecordedMemoryScore score = scoreRecordedMemory(moments, field());
  EXPECT_EQ(score.moments_without_pose, 1);
  EXPECT_FALSE(score.distance_m);
  EXPECT_FALSE(score.last);
}

}  // namespace
}  // namespace vismem
