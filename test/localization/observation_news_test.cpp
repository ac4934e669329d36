// What lies where it lay tells the same again (DESIGN 9 part 4).
#include "localization/core/observation_news.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vismem {
namespace {

constexpr StampUs kTick_us = kSecondUs / 5;

class WhatWasSeenBefore : public testing::Test {
 protected:
  WhatWasSeenBefore() : news_(params_) {}

  /// A line of 1 m across the view, so far ahead of a robot that stands at a place in odometry.
  RobustObservation look(double ahead_m, const Pose2& T_odom_robot = {}, int label = 0) {
    RobustObservation seen;
    for (int i = 0; i < 10; ++i) {
      EvidencePoint point;
      point.p_robot = {ahead_m, -0.45 + 0.1 * i};
      point.direction_robot = M_PI / 2;
      point.label = label;
      point.sigma_m = 0.03;
      point.weight = 0.5;
      seen.points.push_back(point);
    }
    stamp_us_ += kTick_us;
    news_.weigh(seen, T_odom_robot, stamp_us_);
    return seen;
  }

  RobustParams params_;
  ObservationNews news_;
  StampUs stamp_us_ = 0;
};

TEST_F(WhatWasSeenBefore, IsNewOnceAndCountsHalfAfterSoManyTimes) {
  EXPECT_DOUBLE_EQ(look(2.0).news, 1.0);
  EXPECT_NEAR(look(2.0).news, 1.0 / (1.0 + 1.0 / params_.repeats), 0.02);
  for (int i = 2; i < static_cast<int>(params_.repeats); ++i) look(2.0);
  EXPECT_NEAR(look(2.0).news, 0.5, 0.03);
}

TEST_F(WhatWasSeenBefore, TellsInAllAFewImagesWorthHoweverLongItLies) {
  double sum = 0.0;
  for (int i = 0; i < 150; ++i) sum += look(2.0).news;  // half a minute
  EXPECT_LT(sum, 0.15 * 150);
  EXPECT_GT(sum, params_.repeats);
}

TEST_F(WhatWasSeenBefore, IsAnotherThingElsewhereOrWithAnotherLabel) {
  for (int i = 0; i < 5; ++i) look(2.0);
  EXPECT_DOUBLE_EQ(look(3.0).news, 1.0);
  EXPECT_DOUBLE_EQ(look(2.0, {}, 1).news, 1.0);
  EXPECT_LT(look(2.0).news, 0.5);
}

TEST_F(WhatWasSeenBefore, IsTheSameFromElsewhere) {
  for (int i = 0; i < 5; ++i) look(2.0);
  // A metre nearer, and a little beside for the noise of a floor point.
  EXPECT_LT(look(1.06, {1.0, 0.0, 0.0}).news, 0.5);
  // Turned about by half a turn and gone to the other side of it.
  EXPECT_LT(look(2.0, {4.0, 0.0, M_PI}).news, 0.5);
}

TEST_F(WhatWasSeenBefore, OfAnObservationIsTheShareByWeight) {
  look(2.0);
  RobustObservation both;
  EvidencePoint point;
  point.label = 0;
  point.p_robot = {2.0, 0.0};
  point.weight = 3.0;
  both.points.push_back(point);
  point.p_robot = {4.0, 0.0};
  point.weight = 1.0;
  both.points.push_back(point);
  news_.weigh(both, {}, stamp_us_ + kTick_us);
  EXPECT_DOUBLE_EQ(both.points[1].news, 1.0);
  EXPECT_NEAR(both.news, 0.75 * both.points[0].news + 0.25, 1e-12);
  EXPECT_LT(both.points[0].news, 0.8);
}

TEST_F(WhatWasSeenBefore, IsNewAgainAfterLongAndWhenOdometryJumped) {
  for (int i = 0; i < 5; ++i) look(2.0);
  stamp_us_ += toStampUs(6.0 * params_.repeat_time_s);
  EXPECT_GT(look(2.0).news, 0.95);
  news_.clear();
  EXPECT_DOUBLE_EQ(look(2.0).news, 1.0);
}

TEST_F(WhatWasSeenBefore, CountsInFullWhereThatIsSwitchedOff) {
  params_.repeats = 0.0;
  for (int i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(look(2.0).news, 1.0);
}

}  // namespace
}  // namespace vismem
