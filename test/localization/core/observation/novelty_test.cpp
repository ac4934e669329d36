// Tests L12.
#include "localization/core/observation/novelty.h"

#include <gtest/gtest.h>

#include <numbers>

namespace vismem {
namespace {

class ObservationNoveltyTest : public testing::Test {
 protected:
  /// Novelty of a line of 1 m across the view, `ahead_m` in front of the robot, a tick after the last one.
  double look(double ahead_m, const Pose2& T_odom_robot = {}, int label = 0) {
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
    stamp_us_ += kSecondUs / 5;
    return novelty_.assess(seen, T_odom_robot, stamp_us_);
  }

  ObservationNovelty novelty_;
  StampUs stamp_us_ = 0;
};

TEST_F(ObservationNoveltyTest, FallsFromOneToAHalfInThreeViews) {
  EXPECT_DOUBLE_EQ(look(2.0), 1.0);
  EXPECT_NEAR(look(2.0), 0.75, 0.02);
  look(2.0);
  EXPECT_NEAR(look(2.0), 0.5, 0.02);
}

TEST_F(ObservationNoveltyTest, SumsToFewImagesInAMinute) {
  double sum = 0.0;
  for (int i = 0; i < 300; ++i) sum += look(2.0);
  EXPECT_LT(sum, 20.0);
}

TEST_F(ObservationNoveltyTest, IsOneElsewhereWithAnotherLabelAndAfterAReset) {
  for (int i = 0; i < 5; ++i) look(2.0);
  EXPECT_DOUBLE_EQ(look(3.0), 1.0);
  EXPECT_DOUBLE_EQ(look(2.0, {}, 1), 1.0);
  EXPECT_LT(look(2.0), 0.5);
  novelty_.reset();
  EXPECT_DOUBLE_EQ(look(2.0), 1.0);
}

TEST_F(ObservationNoveltyTest, DoesNotDependOnTheRobotsPose) {
  for (int i = 0; i < 5; ++i) look(2.0);
  // A metre nearer, and a little beside for the noise of a floor point.
  EXPECT_LT(look(1.06, {1.0, 0.0, 0.0}), 0.5);
  // Turned about by half a turn and gone to the other side of it.
  EXPECT_LT(look(2.0, {4.0, 0.0, std::numbers::pi}), 0.5);
}

TEST_F(ObservationNoveltyTest, ReturnsInMinutes) {
  for (int i = 0; i < 5; ++i) look(2.0);
  stamp_us_ += toStampUs(360.0);
  EXPECT_GT(look(2.0), 0.95);
}

TEST_F(ObservationNoveltyTest, IsOneWithoutPoints) {
  EXPECT_DOUBLE_EQ(novelty_.assess({}, {}, 1), 1.0);
}

}  // namespace
}  // namespace vismem
