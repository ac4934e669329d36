// Tests L6, L12.
#include "localization/core/hypotheses/tracking.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

class TrackingTest : public testing::Test {
 protected:
  void iterate(bool is_inconsistent, bool is_unambiguous, bool has_winner = true) {
    state_ = nextTracking(state_, {has_winner, is_inconsistent, is_unambiguous});
  }
  void agree(int iterations) {
    for (int i = 0; i < iterations; ++i) iterate(false, true);
  }

  TrackingState state_;
};

TEST_F(TrackingTest, IsLostWithoutAWinnerAndAmbiguousWithANewOne) {
  EXPECT_EQ(state_.mode, Tracking::kLost);
  iterate(false, false, false);
  EXPECT_EQ(state_.mode, Tracking::kLost);
  iterate(false, false);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
}

TEST_F(TrackingTest, TracksAfterFifteenUnambiguousIterationsUntilARivalAppears) {
  agree(14);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  agree(1);
  EXPECT_EQ(state_.mode, Tracking::kTracking);
  iterate(false, false);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
}

TEST_F(TrackingTest, TheLossOfTheWinnerIsLost) {
  agree(15);
  iterate(false, false, false);
  EXPECT_EQ(state_.mode, Tracking::kLost);
}

TEST_F(TrackingTest, AnInconsistentImageAfterFifteenConsistentOnesEndsTracking) {
  agree(15);
  iterate(true, true);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  agree(14);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  agree(1);
  EXPECT_EQ(state_.mode, Tracking::kTracking);
}

TEST_F(TrackingTest, FrequentInconsistentImagesDoNotPreventTracking) {
  for (int i = 0; i < 30; ++i) iterate(i % 2 == 1, true);
  EXPECT_EQ(state_.mode, Tracking::kTracking) << "lines that the map lacks are no jump of the robot";
}

TEST_F(TrackingTest, ARestartEndsTracking) {
  agree(15);
  state_ = restartedTracking(state_, true);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  EXPECT_EQ(restartedTracking(state_, false).mode, Tracking::kLost);
}

}  // namespace
}  // namespace vismem
