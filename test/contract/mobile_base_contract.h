/// @file Contract tests of every MobileBase (components/common/robot/ports.h). A file of each implementation
/// instantiates the suites that apply, see pantilt_contract.h.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/angles.h"
#include "contract/sampled_port.h"

namespace vismem::contract {

using MobileBaseImplementation = Implementation<MobileBase>;

class MobileBaseSuite : public testing::TestWithParam<MobileBaseImplementation> {
 protected:
  MobileBase& base() { return subject->port(); }

  std::unique_ptr<Subject<MobileBase>> subject = GetParam().make();
};

class MobileBaseSamples : public MobileBaseSuite {};

TEST_P(MobileBaseSamples, StartsAndStopsAsOftenAsOneLikes) {
  startsAndStopsAsOftenAsOneLikes(*subject);
}
TEST_P(MobileBaseSamples, StampsAndNumbersRise) {
  stampsAndNumbersRise(*subject);
}
TEST_P(MobileBaseSamples, GivesWhatIsNewerAndStillHeld) {
  givesWhatIsNewerAndStillHeld(*subject);
}
TEST_P(MobileBaseSamples, WaitsForItsWholeTimeout) {
  waitsForItsWholeTimeout(*subject);
}

class MobileBaseMotion : public MobileBaseSuite {
 protected:
  void SetUp() override {
    ASSERT_TRUE(base().start().ok());
    ASSERT_FALSE(follower.next().empty());  // the limits of a remote one are known now
    limits = base().limits();
    ASSERT_GT(limits.max_speed_mps, 0.0);
    ASSERT_GT(limits.max_turn_rate_radps, 0.0);
    v_mps = 0.3 * limits.max_speed_mps;
    w_radps = 0.4 * limits.max_turn_rate_radps;
  }
  static bool stands(const OdometrySample& s) { return s.v_mps == 0.0 && s.w_radps == 0.0; }
  /// Commands these speeds until they are reached.
  std::optional<OdometrySample> reach(double v, double w) {
    return follower.until([&](const OdometrySample& s) { return drives(s, v, w); },
                          [&] { EXPECT_TRUE(base().setVelocity(v, w).ok()); });
  }

  bool drives(const OdometrySample& s, double v, double w) const {
    return std::abs(s.v_mps - v) < 0.02 * limits.max_speed_mps &&
           std::abs(s.w_radps - w) < 0.02 * limits.max_turn_rate_radps;
  }
  /// Drives half a second at these speeds. On a busy machine late commands let the watchdog brake, or samples
  /// have late stamps: the drive is then repeated a few times.
  std::vector<OdometrySample> steadyDrive(double v, double w) {
    std::vector<OdometrySample> samples;
    for (int attempt = 0; attempt < 5; ++attempt) {
      EXPECT_TRUE(reach(v, w));
      samples = follower.during(kSecondUs / 2, [&] { EXPECT_TRUE(base().setVelocity(v, w).ok()); });
      StampUs shortest = kSecondUs;
      StampUs longest = 0;
      bool steady = true;
      for (std::size_t i = 1; i < samples.size(); ++i) {
        shortest = std::min(shortest, samples[i].stamp_us - samples[i - 1].stamp_us);
        longest = std::max(longest, samples[i].stamp_us - samples[i - 1].stamp_us);
        steady = steady && drives(samples[i], v, w);
      }
      if (steady && longest <= 2 * shortest) break;
    }
    return samples;
  }

  BaseLimits limits;
  double v_mps = 0.0;
  double w_radps = 0.0;
  Follower<MobileBase> follower{*subject};
};

TEST_P(MobileBaseMotion, DrivesAsCommandedAndItsOdometryAgrees) {
  const auto samples = steadyDrive(v_mps, w_radps);
  ASSERT_FALSE(samples.empty());
  const OdometrySample& from = samples.front();
  const OdometrySample& to = samples.back();
  const double took_s = toSeconds(to.stamp_us - from.stamp_us);
  const Pose2 moved = inverse(from.T_odom_robot) * to.T_odom_robot;
  // v forward and w counter-clockwise: an arc to the left; the chord of an arc of that angle.
  const double turned = w_radps * took_s;
  EXPECT_NEAR(moved.theta, turned, 0.1 * turned + 0.01);
  const double chord = v_mps * took_s * std::sin(0.5 * turned) / (0.5 * turned);
  EXPECT_NEAR(moved.position().norm(), chord, 0.1 * chord + 0.005);
  EXPECT_GT(moved.x, 0.0);
  EXPECT_GT(moved.y, 0.0);
  // Backwards and to the right.
  ASSERT_TRUE(reach(-v_mps, 0.0));
  const auto back = follower.during(kSecondUs / 5, [&] { base().setVelocity(-v_mps, 0.0); });
  EXPECT_LT((inverse(back.front().T_odom_robot) * back.back().T_odom_robot).x, -0.1 * v_mps);
  ASSERT_TRUE(reach(0.0, -w_radps));
}

/// Held for a while, then the base stops by itself: within half a second of the last command.
TEST_P(MobileBaseMotion, HoldsACommandUntilItsWatchdogStopsIt) {
  ASSERT_GT(limits.watchdog_s, 0.0);
  ASSERT_LE(limits.watchdog_s, 0.4) << "so that it stands within 0.5 s of its last command";
  ASSERT_TRUE(reach(0.9 * limits.max_speed_mps, 0.9 * limits.max_turn_rate_radps));
  ASSERT_TRUE(base().setVelocity(0.9 * limits.max_speed_mps, 0.9 * limits.max_turn_rate_radps).ok());
  // The command was taken after the newest sample that the port has now was made, or with it.
  const auto now = base().samplesSince(kEverything, 1000ms).samples;
  ASSERT_FALSE(now.empty());
  const StampUs last_command_us = std::max(now.back().stamp_us, follower.newest());
  StampUs slower_us = 0;
  const auto standing = follower.until([&](const OdometrySample& s) {
    if (slower_us == 0 && s.v_mps < 0.8 * limits.max_speed_mps) slower_us = s.stamp_us;
    return stands(s);
  });
  ASSERT_TRUE(standing);
  EXPECT_GT(toSeconds(slower_us - last_command_us), 0.5 * limits.watchdog_s) << "held until then";
  EXPECT_LT(toSeconds(standing->stamp_us - last_command_us), 0.5);
  for (const OdometrySample& s : follower.during(kSecondUs / 5)) EXPECT_TRUE(stands(s));
}

TEST_P(MobileBaseMotion, AdjustsWhatIsBeyondItsLimitsAndSaysSo) {
  const PortReply fast = base().setVelocity(5.0 * limits.max_speed_mps, 0.0);
  EXPECT_EQ(fast.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(fast.message, testing::HasSubstr("speed"));
  const PortReply turning = base().setVelocity(0.0, -5.0 * limits.max_turn_rate_radps);
  EXPECT_EQ(turning.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(turning.message, testing::HasSubstr("turn rate"));
  const auto fastest = follower.during(
      kSecondUs, [&] { base().setVelocity(5.0 * limits.max_speed_mps, 5.0 * limits.max_turn_rate_radps); });
  for (const OdometrySample& s : fastest) {
    EXPECT_LE(std::abs(s.v_mps), limits.max_speed_mps * 1.001);
    EXPECT_LE(std::abs(s.w_radps), limits.max_turn_rate_radps * 1.001);
  }
}

TEST_P(MobileBaseMotion, RefusesWhatMakesNoSenseAndDoesNotMove) {
  for (const double absurd : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const PortReply& reply : {base().setVelocity(absurd, 0.1), base().setVelocity(0.1, absurd)}) {
      EXPECT_EQ(reply.kind, PortReply::Kind::kRejected);
      EXPECT_THAT(reply.message, testing::HasSubstr("finite"));
    }
  }
  for (const OdometrySample& s : follower.during(kSecondUs / 5)) EXPECT_TRUE(stands(s));
}

TEST_P(MobileBaseMotion, StandsWhenStoppedAndObeysWhenStartedAgain) {
  ASSERT_TRUE(reach(v_mps, 0.0));
  base().stop();
  ASSERT_TRUE(base().start().ok());
  const StampUs started_us = follower.newest();
  const auto standing = follower.until(stands);
  ASSERT_TRUE(standing);
  EXPECT_LT(toSeconds(standing->stamp_us - started_us), 0.5);
  for (const OdometrySample& s : follower.during(kSecondUs / 5)) {
    EXPECT_TRUE(stands(s)) << "the speed of the life before is forgotten";
  }
  EXPECT_TRUE(reach(v_mps, 0.0));
}

class MobileBaseThreads : public MobileBaseSuite {};

TEST_P(MobileBaseThreads, TakesCommandsWhileAnotherThreadWaits) {
  takesCommandsWhileOthersWait<MobileBase>(
      *subject, [&](int i) { return base().setVelocity(0.01 * (i % 5), 0.02 * (i % 3)); });
}
TEST_P(MobileBaseThreads, StopEndsAWait) {
  stopEndsAWait(*subject);
}

class MobileBaseRecorded : public MobileBaseSuite {};

TEST_P(MobileBaseRecorded, TakesCommandsAndSaysThatItIgnoresThem) {
  ASSERT_TRUE(base().start().ok());
  EXPECT_EQ(base().setVelocity(0.1, 0.0).kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(base().setVelocity(0.1, 0.0).message, testing::HasSubstr("ignored"));
  EXPECT_EQ(base().setVelocity(std::nan(""), 0.0).kind, PortReply::Kind::kRejected);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MobileBaseSamples);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MobileBaseMotion);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MobileBaseThreads);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MobileBaseRecorded);

}  // namespace vismem::contract
