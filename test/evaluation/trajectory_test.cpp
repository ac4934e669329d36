#include "evaluation/core/trajectory.h"

#include <gtest/gtest.h>

#include <numbers>

namespace vismem {
namespace {

TEST(Trajectory, AnswersOnlyInsideItsSpanAndShortGaps) {
  const Trajectory t{{0, {0, 0, 0}}, {500'000, {1, 0, 0}}, {2'500'000, {3, 0, 0}}};
  EXPECT_FALSE(poseAt(t, -1));
  EXPECT_FALSE(poseAt(t, 2'500'001));
  EXPECT_FALSE(poseAt(t, kSecondUs)) << "two seconds between the neighbours";
  EXPECT_NEAR(poseAt(t, 250'000)->x, 0.5, 1e-12);
  EXPECT_NEAR(poseAt(t, 2'500'000)->x, 3.0, 1e-12);
  EXPECT_NEAR(pathLength(t), 3.0, 1e-12);
}

TEST(Trajectory, TakesOnlyNewerPoses) {
  Trajectory t;
  EXPECT_TRUE(append(t, {kSecondUs, {1, 0, 0}}));
  EXPECT_FALSE(append(t, {kSecondUs, {2, 0, 0}})) << "the same stamp";
  EXPECT_FALSE(append(t, {0, {3, 0, 0}})) << "older";
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t[0].pose.x, 1.0);
}

TEST(Trajectory, MovesEveryPoseByATransform) {
  // a is one metre along x from b and turned by a quarter: b's x axis is a's y axis.
  const Trajectory moved = transform(Pose2{1.0, 0.0, std::numbers::pi / 2}, {{7, {2.0, 0.0, 0.0}}});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].stamp_us, 7);
  EXPECT_NEAR(moved[0].pose.x, 1.0, 1e-12);
  EXPECT_NEAR(moved[0].pose.y, 2.0, 1e-12);
  EXPECT_NEAR(moved[0].pose.theta, std::numbers::pi / 2, 1e-12);
}

}  // namespace
}  // namespace vismem
