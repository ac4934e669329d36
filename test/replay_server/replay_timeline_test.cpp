#include "replay_server/core/replay_timeline.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

/// A log of 10 s that begins at stamp 100 s; the clock begins at 5 s.
constexpr StampUs kBegin = 100 * kSecondUs;
constexpr StampUs kEnd = 110 * kSecondUs;
constexpr StampUs kNow = 5 * kSecondUs;

ReplayTimeline timeline(double rate = 1.0, bool loop = false, ReplayState state = ReplayState::kPlaying) {
  return {kBegin, kEnd, rate, loop, state, kNow};
}

TEST(ReplayTimeline, FollowsTheClockAtItsRate) {
  ReplayTimeline replay = timeline(2.0);
  replay.update(kNow + 3 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + 6 * kSecondUs);
  EXPECT_EQ(*replay.clockAt(kBegin + 8 * kSecondUs), kNow + 4 * kSecondUs);
  EXPECT_FALSE(replay.clockAt(kBegin).has_value()) << "is past";
}

TEST(ReplayTimeline, ReachesAStampWhenTheClockSaysSo) {
  ReplayTimeline replay = timeline(0.37);
  for (const StampUs stamp_us : {kBegin + 1, kBegin + 333'333, kBegin + 4'000'001}) {
    const StampUs due_us = *replay.clockAt(stamp_us);
    replay.update(due_us - 3);
    EXPECT_LT(replay.position(), stamp_us);
    replay.update(due_us);
    EXPECT_GE(replay.position(), stamp_us) << "a waiter that wakes on time must find it there";
  }
}

TEST(ReplayTimeline, StandsStillUntilPlayed) {
  ReplayTimeline replay = timeline(1.0, false, ReplayState::kWaiting);
  replay.update(kNow + 50 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kWaiting);
  EXPECT_EQ(replay.position(), kBegin);
  replay.play(kNow + 50 * kSecondUs);
  replay.update(kNow + 51 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + kSecondUs);
}

TEST(ReplayTimeline, PausesAndGoesOnWhereItWas) {
  ReplayTimeline replay = timeline();
  replay.pause(kNow + 2 * kSecondUs);
  replay.update(kNow + 4 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + 2 * kSecondUs);
  EXPECT_FALSE(replay.clockAt(kEnd).has_value());
  replay.play(kNow + 5 * kSecondUs);
  replay.update(kNow + 6 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + 3 * kSecondUs);
  EXPECT_EQ(replay.jumps(), 0u);
}

TEST(ReplayTimeline, FinishesAtItsEndAndBeginsAgain) {
  ReplayTimeline replay = timeline();
  replay.update(kNow + 60 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kFinished);
  EXPECT_EQ(replay.position(), kEnd);
  replay.pause(kNow + 61 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kFinished) << "the end stays the end";
  replay.play(kNow + 62 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kPlaying);
  EXPECT_EQ(replay.position(), kBegin);
  EXPECT_EQ(replay.jumps(), 1u);
}

TEST(ReplayTimeline, LoopsToItsBeginning) {
  ReplayTimeline replay = timeline(1.0, true);
  replay.update(kNow + 10 * kSecondUs);
  EXPECT_EQ(replay.position(), kEnd);
  EXPECT_EQ(replay.jumps(), 0u);
  replay.update(kNow + 10 * kSecondUs + 1);
  EXPECT_EQ(replay.position(), kBegin);
  EXPECT_EQ(replay.jumps(), 1u);
  EXPECT_EQ(replay.state(), ReplayState::kPlaying);
}

TEST(ReplayTimeline, SeeksInsideTheLog) {
  ReplayTimeline replay = timeline();
  EXPECT_EQ(replay.seek(kBegin + 7 * kSecondUs, kNow + kSecondUs), kBegin + 7 * kSecondUs);
  EXPECT_EQ(replay.segmentBegin(), kBegin + 7 * kSecondUs);
  EXPECT_EQ(replay.jumps(), 1u);
  replay.update(kNow + 2 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + 8 * kSecondUs);
  EXPECT_EQ(replay.seek(0, kNow + 2 * kSecondUs), kBegin);
  EXPECT_EQ(replay.seek(kEnd + 1, kNow + 2 * kSecondUs), kEnd);
  replay.update(kNow + 2 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kFinished);
  replay.seek(kBegin, kNow + 3 * kSecondUs);
  EXPECT_EQ(replay.state(), ReplayState::kPlaying);
}

TEST(ReplayTimeline, ChangesItsRateWithoutAJump) {
  ReplayTimeline replay = timeline();
  replay.setRate(4.0, kNow + kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + kSecondUs);
  replay.update(kNow + 2 * kSecondUs);
  EXPECT_EQ(replay.position(), kBegin + 5 * kSecondUs);
  EXPECT_EQ(replay.jumps(), 0u);
}

}  // namespace
}  // namespace vismem
