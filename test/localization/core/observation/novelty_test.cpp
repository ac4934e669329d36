// Tests L12.
#include "localization/core/observation/novelty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vismem {
namespace {

constexpr StampUs kTick_us = kSecondUs / 5;

class NoveltyTest : public testing::Test {
 protected:
  NoveltyTest() : novelty_(params_) {}

  /// A line of 1 m across the view, `ahead_m` in front of the robot.
  FloorObservation look(double ahead_m, const Pose2& T_odom_robot = {}, int label = 0) {
    FloorObservation seen;
    for (int i = 0; i < 10; ++i) {
      FloorPoint point;
      point.p_robot = {ahead_m, -0.45 + 0.1 * i};
      point.direction_robot = std::numbers::pi / 2;
      point.label = label;
      point.sigma_m = 0.03;
      point.weight = 0.5;
      seen.points.push_back(point);
    }
    stamp_us_ += kTick_us;
    novelty_.assess(seen, T_odom_robot, stamp_us_);
    return seen;
  }

  NoveltyParams params_;
  ObservationNovelty novelty_;
  StampUs stamp_us_ = 0;
};

TEST_F(NoveltyTest, IsOneAtFirstAndHalfAfterTheConfiguredViews) {
  EXPECT_DOUBLE_EQ(look(2.0).novelty, 1.0);
  EXPECT_NEAR(look(2.0).novelty, 1.0 / (1.0 + 1.0 / params_.half_novelty_views), 0.02);
  for (int i = 2; i < static_cast<int>(params_.half_novelty_views); ++i) look(2.0);
  EXPECT_NEAR(look(2.0).novelty, 0.5, 0.03);
}

TEST_F(NoveltyTest, SumsToFewImagesForALastingObject) {
  double sum = 0.0;
  for (int i = 0; i < 150; ++i) sum += look(2.0).novelty;  // half a minute
  EXPECT_LT(sum, 0.15 * 150);
  EXPECT_GT(sum, params_.half_novelty_views);
}

TEST_F(NoveltyTest, IsOneElsewhereOrWithAnotherLabel) {
  for (int i = 0; i < 5; ++i) look(2.0);
  EXPECT_DOUBLE_EQ(look(3.0).novelty, 1.0);
  EXPECT_DOUBLE_EQ(look(2.0, {}, 1).novelty, 1.0);
  EXPECT_LT(look(2.0).novelty, 0.5);
}

TEST_F(NoveltyTest, DoesNotDependOnTheRobotsPose) {
  for (int i = 0; i < 5; ++i) look(2.0);
  // A metre nearer, and a little beside for the noise of a floor point.
  EXPECT_LT(look(1.06, {1.0, 0.0, 0.0}).novelty, 0.5);
  // Turned about by half a turn and gone to the other side of it.
  EXPECT_LT(look(2.0, {4.0, 0.0, std::numbers::pi}).novelty, 0.5);
}

TEST_F(NoveltyTest, OfAnObservationIsTheShareByWeight) {
  look(2.0);
  FloorObservation both;
  FloorPoint point;
  point.label = 0;
  point.p_robot = {2.0, 0.0};
  point.weight = 3.0;
  both.points.push_back(point);
  point.p_robot = {4.0, 0.0};
  point.weight = 1.0;
  both.points.push_back(point);
  novelty_.assess(both, {}, stamp_us_ + kTick_us);
  EXPECT_DOUBLE_EQ(both.points[1].novelty, 1.0);
  EXPECT_NEAR(both.novelty, 0.75 * both.points[0].novelty + 0.25, 1e-12);
  EXPECT_LT(both.points[0].novelty, 0.8);
}

TEST_F(NoveltyTest, ReturnsToOneAfterALongTimeAndAReset) {
  for (int i = 0; i < 5; ++i) look(2.0);
  stamp_us_ += toStampUs(6.0 * params_.novelty_decay_s);
  EXPECT_GT(look(2.0).novelty, 0.95);
  novelty_.reset();
  EXPECT_DOUBLE_EQ(look(2.0).novelty, 1.0);
}

TEST_F(NoveltyTest, IsOneWhenSwitchedOff) {
  params_.half_novelty_views = 0.0;
  novelty_ = ObservationNovelty(params_);
  for (int i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(look(2.0).novelty, 1.0);
}

}  // namespace
}  // namespace vismem
