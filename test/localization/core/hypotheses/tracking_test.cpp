// Tests L6, L12.
#include "localization/core/hypotheses/tracking.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

/// One iteration per 0.2 s.
class TrackingTest : public testing::Test {
 protected:
  void iterate(bool is_inconsistent, bool is_unambiguous, bool has_winner = true) {
    stamp_us_ += kSecondUs / 5;
    state_ = nextTracking(state_, {stamp_us_, has_winner, is_inconsistent, is_unambiguous});
  }
  void agree(int iterations) {
    for (int i = 0; i < iterations; ++i) iterate(false, true);
  }
  bool isSuspicious() const { return isSuspect(state_, stamp_us_); }

  TrackingState state_;
  StampUs stamp_us_ = 0;
};

TEST_F(TrackingTest, IsLostWithoutAWinnerAndAmbiguousWithANewOne) {
  EXPECT_EQ(state_.mode, Tracking::kLost);
  iterate(false, false, false);
  EXPECT_EQ(state_.mode, Tracking::kLost);
  iterate(false, false);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  EXPECT_FALSE(isSuspicious());
}

TEST_F(TrackingTest, TracksAfterFifteenUnambiguousIterationsUntilARivalAppears) {
  agree(14);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  agree(1);
  EXPECT_EQ(state_.mode, Tracking::kTracking);
  iterate(false, false);
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  EXPECT_FALSE(isSuspicious()) << "a rival alone is no contradiction by an image";
}

TEST_F(TrackingTest, TheLossOfTheWinnerIsLost) {
  agree(15);
  iterate(false, false, false);
  EXPECT_EQ(state_.mode, Tracking::kLost);
}

TEST_F(TrackingTest, SuspicionBeginsOnlyAfterFifteenConsistentImages) {
  agree(14);
  iterate(true, true);
  EXPECT_FALSE(isSuspicious());
  agree(15);
  ASSERT_EQ(state_.mode, Tracking::kTracking);
  iterate(true, true);
  EXPECT_TRUE(isSuspicious());
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  const std::optional<StampUs> since_us = state_.suspect_since_us;
  iterate(true, true);
  EXPECT_EQ(state_.suspect_since_us, since_us) << "it lasts, and does not begin again";
}

TEST_F(TrackingTest, SuspicionEndsAfterFiveIterationsOfAgreement) {
  agree(15);
  iterate(true, true);
  for (int i = 0; i < 4; ++i) {
    iterate(false, true);
    EXPECT_TRUE(isSuspicious()) << i;
  }
  iterate(false, true);
  EXPECT_FALSE(isSuspicious());
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous) << "tracking needs nine more";
  agree(9);
  EXPECT_EQ(state_.mode, Tracking::kTracking);
}

TEST_F(TrackingTest, ARivalKeepsTheSuspicionForThreeSeconds) {
  agree(15);
  iterate(true, false);
  const StampUs begin_us = stamp_us_;
  while (isSuspicious()) iterate(false, false);
  EXPECT_EQ(stamp_us_ - begin_us, 3 * kSecondUs);
}

TEST_F(TrackingTest, ARestartEndsTrackingAndSuspicion) {
  agree(15);
  iterate(true, true);
  state_ = restartedTracking(state_, true);
  EXPECT_FALSE(isSuspicious());
  EXPECT_EQ(state_.mode, Tracking::kAmbiguous);
  EXPECT_EQ(restartedTracking(state_, false).mode, Tracking::kLost);
}

}  // namespace
}  // namespace vismem
