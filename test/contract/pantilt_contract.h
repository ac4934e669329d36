/// @file Contract tests of every PanTiltUnit (components/common/robot/ports.h). A file of each implementation
/// instantiates the suites that apply:
// clang-format off
///   PanTiltSamples    all: life, stamps, waits
///   PanTiltMotion     positions, velocities, limits, refusals of what moves
///   PanTiltThreads    several threads use it
///   PanTiltRecorded   a recording: it accepts every command, ignores it and reports so
// clang-format on
#pragma once

#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "contract/sampled_port.h"

namespace vismem::contract {

using PanTiltImplementation = Implementation<PanTiltUnit>;

class PanTiltSuite : public testing::TestWithParam<PanTiltImplementation> {
 protected:
  PanTiltUnit& unit() { return subject->port(); }
  PortReply position(double pan_rad, double tilt_rad, double bound_radps = 0.0) {
    return unit().command({PanTiltCommand::Kind::kPosition, pan_rad, tilt_rad, bound_radps, bound_radps});
  }
  PortReply velocity(double pan_radps, double tilt_radps) {
    return unit().command({PanTiltCommand::Kind::kVelocity, 0.0, 0.0, pan_radps, tilt_radps});
  }
  /// Waits until the angles stay the same for 0.1 s.
  /// @return the last sample.
  std::optional<PanTiltSample> rest(Follower<PanTiltUnit>& follower) {
    std::optional<PanTiltSample> since;
    return follower.until([&](const PanTiltSample& s) {
      const bool moved =
          !since || std::abs(s.pan_rad - since->pan_rad) + std::abs(s.tilt_rad - since->tilt_rad) > kSame_rad;
      if (moved) since = s;
      return s.stamp_us - since->stamp_us >= kSecondUs / 10;
    });
  }

  /// Required accuracy of a unit.
  static constexpr double kReached_rad = 0.01;
  static constexpr double kSame_rad = 1e-4;

  std::unique_ptr<Subject<PanTiltUnit>> subject = GetParam().make();
};

class PanTiltSamples : public PanTiltSuite {};

TEST_P(PanTiltSamples, StartsAndStopsAsOftenAsOneLikes) {
  startsAndStopsAsOftenAsOneLikes(*subject);
}
TEST_P(PanTiltSamples, StampsAndNumbersRise) {
  stampsAndNumbersRise(*subject);
}
TEST_P(PanTiltSamples, GivesWhatIsNewerAndStillHeld) {
  givesWhatIsNewerAndStillHeld(*subject);
}
TEST_P(PanTiltSamples, WaitsForItsWholeTimeout) {
  waitsForItsWholeTimeout(*subject);
}

class PanTiltMotion : public PanTiltSuite {
 protected:
  void SetUp() override {
    ASSERT_TRUE(unit().start().ok());
    ASSERT_FALSE(follower.next().empty());  // the limits of a remote one are known now
    limits = unit().limits();
    ASSERT_LT(limits.min_pan_rad, limits.max_pan_rad);
    ASSERT_LT(limits.min_tilt_rad, limits.max_tilt_rad);
    ASSERT_GT(limits.max_pan_rate_radps, 0.0);
    ASSERT_GT(limits.max_tilt_rate_radps, 0.0);
  }

  PanTiltLimits limits;
  Follower<PanTiltUnit> follower{*subject};
};

TEST_P(PanTiltMotion, ReachesAPositionAndStaysThere) {
  const double pan = 0.4 * limits.max_pan_rad;
  const double tilt = 0.6 * limits.min_tilt_rad;
  ASSERT_EQ(position(pan, tilt).kind, PortReply::Kind::kAccepted);
  ASSERT_TRUE(follower.until([&](const PanTiltSample& s) {
    EXPECT_LT(s.pan_rad, pan + kReached_rad);
    EXPECT_GT(s.tilt_rad, tilt - kReached_rad);
    return std::abs(s.pan_rad - pan) < kReached_rad && std::abs(s.tilt_rad - tilt) < kReached_rad;
  }));
  for (const PanTiltSample& s : follower.during(kSecondUs / 5)) {
    EXPECT_NEAR(s.pan_rad, pan, kReached_rad);
    EXPECT_NEAR(s.tilt_rad, tilt, kReached_rad);
  }
}

TEST_P(PanTiltMotion, KeepsTheBoundOfTheRateOnTheWay) {
  const double bound = 0.3 * limits.max_pan_rate_radps;
  const double pan = 0.5 * bound;  // half a second away
  const StampUs began_us = follower.newest();
  ASSERT_EQ(position(pan, 0.0, bound).kind, PortReply::Kind::kAccepted);
  const auto there = follower.until([&](const PanTiltSample& s) { return s.pan_rad > pan - kReached_rad; });
  ASSERT_TRUE(there);
  EXPECT_GT(toSeconds(there->stamp_us - began_us), 0.9 * (pan - kReached_rad) / bound);
}

TEST_P(PanTiltMotion, HoldsAVelocityUntilTheNextCommand) {
  const double rate = 0.2 * limits.max_pan_rate_radps;
  ASSERT_EQ(velocity(rate, -0.5 * rate).kind, PortReply::Kind::kAccepted);
  ASSERT_TRUE(follower.until([&](const PanTiltSample& s) { return s.pan_rad > 0.1 * rate; }));
  const auto moving = follower.during(kSecondUs / 2);
  const double took_s = toSeconds(moving.back().stamp_us - moving.front().stamp_us);
  EXPECT_NEAR((moving.back().pan_rad - moving.front().pan_rad) / took_s, rate, 0.15 * rate);
  EXPECT_NEAR((moving.back().tilt_rad - moving.front().tilt_rad) / took_s, -0.5 * rate, 0.15 * rate);
  ASSERT_EQ(velocity(0.0, 0.0).kind, PortReply::Kind::kAccepted);
  const auto standing = rest(follower);
  ASSERT_TRUE(standing);
  // A position takes over from a velocity as well.
  ASSERT_TRUE(velocity(-rate, 0.0).ok());
  ASSERT_TRUE(position(standing->pan_rad + 0.1, standing->tilt_rad).ok());
  EXPECT_TRUE(follower.until(
      [&](const PanTiltSample& s) { return std::abs(s.pan_rad - standing->pan_rad - 0.1) < kReached_rad; }));
}

TEST_P(PanTiltMotion, StopsAtItsLimits) {
  ASSERT_EQ(velocity(0.0, limits.max_tilt_rate_radps).kind, PortReply::Kind::kAccepted);
  const auto within = [&](const PanTiltSample& s) {
    EXPECT_LE(s.tilt_rad, limits.max_tilt_rad + kSame_rad);
    return s.tilt_rad > limits.max_tilt_rad - kReached_rad;
  };
  ASSERT_TRUE(follower.until(within));
  for (const PanTiltSample& s : follower.during(kSecondUs / 5)) EXPECT_TRUE(within(s));
}

TEST_P(PanTiltMotion, AdjustsWhatIsBeyondItsLimitsAndSaysSo) {
  const PortReply far = position(0.0, limits.min_tilt_rad - 0.5);
  EXPECT_EQ(far.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(far.message, testing::HasSubstr("tilt"));
  EXPECT_TRUE(follower.until(
      [&](const PanTiltSample& s) { return std::abs(s.tilt_rad - limits.min_tilt_rad) < kReached_rad; }));
  const PortReply fast = velocity(3.0 * limits.max_pan_rate_radps, 0.0);
  EXPECT_EQ(fast.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(fast.message, testing::HasSubstr("pan"));
  // A rate bound above the maximum is no adjustment.
  EXPECT_EQ(position(0.0, 0.0, 1e6).kind, PortReply::Kind::kAccepted);
}

TEST_P(PanTiltMotion, RefusesWhatMakesNoSenseAndDoesNotMove) {
  ASSERT_TRUE(velocity(0.0, 0.0).ok());
  const auto before = rest(follower);
  ASSERT_TRUE(before);
  using Kind = PanTiltCommand::Kind;
  const double rate = 0.2;
  for (const double absurd : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const PanTiltCommand& command :
         std::initializer_list<PanTiltCommand>{{Kind::kPosition, absurd, 0.1, rate, rate},
                                               {Kind::kPosition, 0.1, absurd, rate, rate},
                                               {Kind::kPosition, 0.1, 0.1, absurd, rate},
                                               {Kind::kPosition, 0.1, 0.1, rate, absurd},
                                               {Kind::kVelocity, 0.0, 0.0, absurd, rate},
                                               {Kind::kVelocity, 0.0, 0.0, rate, absurd}}) {
      const PortReply reply = unit().command(command);
      EXPECT_EQ(reply.kind, PortReply::Kind::kRejected);
      EXPECT_THAT(reply.message, testing::HasSubstr("finite"));
    }
  }
  const PortReply negative = position(0.1, 0.1, -1.0);
  EXPECT_EQ(negative.kind, PortReply::Kind::kRejected);
  EXPECT_THAT(negative.message, testing::HasSubstr(">= 0"));
  for (const PanTiltSample& s : follower.during(kSecondUs / 5)) {
    EXPECT_NEAR(s.pan_rad, before->pan_rad, kSame_rad);
    EXPECT_NEAR(s.tilt_rad, before->tilt_rad, kSame_rad);
  }
}

TEST_P(PanTiltMotion, StandsWhenStoppedAndObeysWhenStartedAgain) {
  const double rate = 0.2 * limits.max_pan_rate_radps;
  ASSERT_TRUE(velocity(rate, 0.0).ok());
  ASSERT_TRUE(follower.until([&](const PanTiltSample& s) { return s.pan_rad > 0.05 * rate; }));
  unit().stop();
  ASSERT_TRUE(unit().start().ok());
  const auto standing = rest(follower);
  ASSERT_TRUE(standing) << "the velocity of the life before is forgotten";
  EXPECT_EQ(position(standing->pan_rad - 0.1, 0.0).kind, PortReply::Kind::kAccepted);
  EXPECT_TRUE(follower.until(
      [&](const PanTiltSample& s) { return std::abs(s.pan_rad - standing->pan_rad + 0.1) < kReached_rad; }));
}

class PanTiltThreads : public PanTiltSuite {};

TEST_P(PanTiltThreads, TakesCommandsWhileAnotherThreadWaits) {
  takesCommandsWhileOthersWait<PanTiltUnit>(
      *subject, [&](int i) { return i % 2 == 0 ? position(0.01 * (i % 7), 0.0) : velocity(0.1, -0.1); });
}
TEST_P(PanTiltThreads, StopEndsAWait) {
  stopEndsAWait(*subject);
}

class PanTiltRecorded : public PanTiltSuite {};

TEST_P(PanTiltRecorded, TakesCommandsAndSaysThatItIgnoresThem) {
  ASSERT_TRUE(unit().start().ok());
  for (const PortReply& reply : {position(0.1, 0.1), velocity(0.1, 0.1)}) {
    EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
    EXPECT_THAT(reply.message, testing::HasSubstr("ignored"));
  }
  EXPECT_EQ(position(std::nan(""), 0.0).kind, PortReply::Kind::kRejected);
}
TEST_P(PanTiltRecorded, AnglesStayWithinTheLimitsItReports) {
  ASSERT_TRUE(unit().start().ok());
  Follower<PanTiltUnit> follower(*subject);
  for (const PanTiltSample& s : follower.during(kSecondUs / 2)) {
    const PanTiltLimits limits = unit().limits();
    EXPECT_GE(s.pan_rad, limits.min_pan_rad);
    EXPECT_LE(s.pan_rad, limits.max_pan_rad);
    EXPECT_GE(s.tilt_rad, limits.min_tilt_rad);
    EXPECT_LE(s.tilt_rad, limits.max_tilt_rad);
  }
}

// A file instantiates the suites that fit its implementation; the others are not forgotten there.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PanTiltSamples);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PanTiltMotion);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PanTiltThreads);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PanTiltRecorded);

}  // namespace vismem::contract
