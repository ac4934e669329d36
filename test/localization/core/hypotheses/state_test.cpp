// Tests L6, L12.
#include "localization/core/hypotheses/state.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

constexpr double kSuspect_s = 3.0;

/// One iteration per 0.2 s.
class TrackingStateTest : public testing::Test {
 protected:
  /// @return true if a suspicion began.
  bool iterate(bool is_inconsistent, bool is_unambiguous) {
    stamp_us_ += kSecondUs / 5;
    const bool begins = state_.addObservation(is_inconsistent, stamp_us_);
    state_.addSelection(is_unambiguous);
    return begins;
  }
  void track(int iterations) {
    for (int i = 0; i < iterations; ++i) ASSERT_FALSE(iterate(false, true));
  }
  bool isSuspect() const { return state_.isSuspect(stamp_us_, kSuspect_s); }

  TrackingState state_;
  StampUs stamp_us_ = 0;
};

TEST_F(TrackingStateTest, IsNeitherSuspectNorIdleAtFirst) {
  EXPECT_FALSE(isSuspect());
  EXPECT_FALSE(state_.isIdle());
  EXPECT_FALSE(state_.isUnambiguous());
}

TEST_F(TrackingStateTest, SuspicionBeginsOnlyAfterFifteenConsistentObservations) {
  track(14);
  EXPECT_FALSE(iterate(true, true));
  EXPECT_FALSE(isSuspect());
  track(15);
  EXPECT_TRUE(iterate(true, true));
  EXPECT_TRUE(isSuspect());
  EXPECT_FALSE(iterate(true, true)) << "it lasts, and does not begin again";
}

TEST_F(TrackingStateTest, SuspicionEndsAfterFiveIterationsOfAgreement) {
  track(15);
  iterate(true, true);
  for (int i = 0; i < 4; ++i) {
    iterate(false, true);
    EXPECT_TRUE(isSuspect()) << i;
  }
  iterate(false, true);
  EXPECT_FALSE(isSuspect());
}

TEST_F(TrackingStateTest, ARivalKeepsTheSuspicionUntilItsLongestTime) {
  track(15);
  iterate(true, false);
  const StampUs begin_us = stamp_us_;
  while (isSuspect()) iterate(false, false);
  EXPECT_EQ(stamp_us_ - begin_us, toStampUs(kSuspect_s));
}

TEST_F(TrackingStateTest, IsIdleAfterFifteenUnambiguousSelectionsUntilAnAmbiguousOne) {
  track(14);
  EXPECT_FALSE(state_.isIdle());
  track(1);
  EXPECT_TRUE(state_.isIdle());
  iterate(false, false);
  EXPECT_FALSE(state_.isIdle());
  EXPECT_FALSE(state_.isUnambiguous());
}

TEST_F(TrackingStateTest, ASuspicionEndsIdling) {
  track(20);
  ASSERT_TRUE(state_.isIdle());
  stamp_us_ += kSecondUs / 5;
  ASSERT_TRUE(state_.addObservation(true, stamp_us_));
  EXPECT_FALSE(state_.isIdle());
}

TEST_F(TrackingStateTest, ResetEndsSuspicionAndIdling) {
  track(15);
  iterate(true, true);
  state_.reset();
  EXPECT_FALSE(isSuspect());
  EXPECT_FALSE(state_.isUnambiguous());
}

}  // namespace
}  // namespace vismem
