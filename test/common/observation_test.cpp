// Units of common/robot: histories that interpolate and the assembler of observations.
// Tests G3.
#include "common/robot/observation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/robot/clock_watch.h"

namespace vismem {
namespace {

OdometrySample odometryAt(StampUs stamp_us, double x, double theta = 0.0) {
  OdometrySample sample;
  sample.stamp_us = stamp_us;
  sample.T_odom_robot = {x, 0.0, theta};
  return sample;
}

PanTiltSample panTiltAt(StampUs stamp_us, double pan_rad) {
  PanTiltSample sample;
  sample.stamp_us = stamp_us;
  sample.pan_rad = pan_rad;
  return sample;
}

Frame frameAt(StampUs stamp_us) {
  Frame frame;
  frame.stamp_us = stamp_us;
  return frame;
}

TEST(SampleHistory, InterpolatesAtTheStamp) {
  SampleHistory<OdometrySample> history(kSecondUs, kSecondUs);
  history.add(odometryAt(100'000, 1.0));
  history.add(odometryAt(200'000, 2.0));
  ASSERT_TRUE(history.at(125'000));
  EXPECT_NEAR(history.at(125'000)->x, 1.25, 1e-12);
}

TEST(SampleHistory, InterpolatesHeadingsTheShortWay) {
  SampleHistory<OdometrySample> history(kSecondUs, kSecondUs);
  history.add(odometryAt(0, 0.0, degToRad(170)));
  history.add(odometryAt(100'000, 0.0, degToRad(-170)));
  EXPECT_NEAR(radToDeg(history.at(25'000)->theta), 175.0, 1e-9);
}

TEST(SampleHistory, KnowsNothingOutsideItsSpanOrInAGap) {
  SampleHistory<OdometrySample> history(10 * kSecondUs, 300'000);
  history.add(odometryAt(0, 0.0));
  history.add(odometryAt(500'000, 1.0));
  EXPECT_FALSE(history.at(-1));
  EXPECT_FALSE(history.at(600'000));
  EXPECT_FALSE(history.at(250'000));
  EXPECT_TRUE(history.at(500'000));
}

TEST(ObservationAssembler, WaitsUntilBothHistoriesCoverTheFrame) {
  ObservationAssembler assembler({});
  assembler.add(odometryAt(0, 0.0));
  assembler.add(panTiltAt(0, 0.0));
  assembler.add(frameAt(50'000));
  EXPECT_FALSE(assembler.take());
  assembler.add(odometryAt(100'000, 0.1));
  EXPECT_FALSE(assembler.take());
  assembler.add(panTiltAt(100'000, 0.2));
  const auto observation = assembler.take();
  ASSERT_TRUE(observation);
  EXPECT_NEAR(observation->T_odom_robot.x, 0.05, 1e-12);
  EXPECT_NEAR(observation->pan_tilt->pan_rad, 0.1, 1e-12);
}

TEST(ObservationAssembler, DropsFramesOlderThanTheHistory) {
  ObservationAssembler assembler({});
  assembler.add(frameAt(50'000));
  assembler.add(odometryAt(100'000, 0.0));
  assembler.add(panTiltAt(100'000, 0.0));
  EXPECT_FALSE(assembler.take());
  EXPECT_EQ(assembler.droppedFrames(), 1u);
}

TEST(ObservationAssembler, LatestFrameWinsUnlessEveryFrameIsWanted) {
  for (const bool every_frame : {false, true}) {
    ObservationAssembler assembler({});
    assembler.add(odometryAt(0, 0.0));
    assembler.add(panTiltAt(0, 0.0));
    assembler.add(frameAt(10'000));
    assembler.add(frameAt(20'000));
    assembler.add(odometryAt(100'000, 0.1));
    assembler.add(panTiltAt(100'000, 0.0));
    const auto observation = assembler.take(every_frame);
    ASSERT_TRUE(observation);
    EXPECT_EQ(observation->frame.stamp_us, every_frame ? 10'000 : 20'000);
  }
}

TEST(ObservationAssembler, BeginsAnEpochWhenTimeOrOdometryJumps) {
  ObservationAssembler assembler({});
  assembler.add(odometryAt(10 * kSecondUs, 0.0));
  EXPECT_EQ(assembler.epoch(), 0u);
  assembler.add(odometryAt(10 * kSecondUs + 50'000, 3.0));
  EXPECT_EQ(assembler.epoch(), 1u);
  assembler.add(odometryAt(2 * kSecondUs, 3.0));
  EXPECT_EQ(assembler.epoch(), 2u);
}

TEST(ObservationAssembler, BeginsAnEpochWhenTheOdometryWasRestartedWhileAway) {
  ObservationAssembler assembler({});
  auto before = odometryAt(10 * kSecondUs, 3.0);
  before.seq = 500;
  assembler.add(before);
  auto continued = odometryAt(20 * kSecondUs, 3.1);
  continued.seq = 501;
  assembler.add(continued);
  EXPECT_EQ(assembler.epoch(), 0u) << "a pause alone is none: the same odometry goes on";
  auto restarted = odometryAt(30 * kSecondUs, 0.0);
  restarted.seq = 0;
  assembler.add(restarted);
  EXPECT_EQ(assembler.epoch(), 1u);
  EXPECT_EQ(assembler.epochReason(), "the odometry was restarted: its numbers went back from 501 to 0");
}

// A restarted source, or a seek in a recording: every stream goes back, and each is noticed at another time.
TEST(ObservationAssembler, StreamsThatGoBackOneAfterTheOtherAreOneEpoch) {
  const StampUs old_us = 100 * kSecondUs;
  const std::vector<std::vector<char>> orders{
      {'o', 'p', 'f'}, {'f', 'o', 'p'}, {'p', 'f', 'o'}, {'o', 'f', 'p'}};
  for (const auto& order : orders) {
    ObservationAssembler assembler({});
    const auto add = [&](char stream, StampUs stamp_us) {
      if (stream == 'o') assembler.add(odometryAt(stamp_us, 0.0));
      if (stream == 'p') assembler.add(panTiltAt(stamp_us, 0.0));
      if (stream == 'f') assembler.add(frameAt(stamp_us));
    };
    for (const char stream : order) add(stream, old_us);
    for (std::size_t gone_back = 1; gone_back <= order.size(); ++gone_back) {
      // Those that have noticed deliver the new time, the others still what was under way of the old one.
      for (std::size_t i = 0; i < order.size(); ++i) {
        const StampUs step_us = static_cast<StampUs>(gone_back) * 10'000;
        add(order[i], i < gone_back ? step_us : old_us + step_us);
      }
    }
    EXPECT_EQ(assembler.epoch(), 1u) << std::string(order.begin(), order.end());
    for (StampUs t = 100'000; t <= 200'000; t += 50'000) {
      for (const char stream : order) add(stream, t);
    }
    const auto observation = assembler.take();
    ASSERT_TRUE(observation) << std::string(order.begin(), order.end());
    EXPECT_EQ(observation->epoch, 1u);
    EXPECT_LT(observation->frame.stamp_us, kSecondUs);
  }
}

TEST(ObservationAssembler, SaysWhyNothingComes) {
  ObservationAssembler assembler({});
  assembler.add(frameAt(50 * kSecondUs));
  EXPECT_EQ(assembler.whyNothing(), "images come, but no sample of the odometry");
  assembler.add(odometryAt(20 * kSecondUs, 0.0));
  EXPECT_EQ(assembler.whyNothing(),
            "the camera's stamps are 30.0 s ahead of those of the odometry (a stream that stopped, or clocks "
            "of hosts "
            "that are out of step)");
  assembler.add(odometryAt(50 * kSecondUs, 0.0));
  EXPECT_EQ(assembler.whyNothing(), "images come, but no sample of the pan-tilt unit");
}

TEST(ClockWatch, ComparesOnlyStampsOfTheSameTimeAndBearsWithAMoment) {
  const StampUs host_us = 1'700'000'000 * kSecondUs;
  ClockWatch clock;
  EXPECT_EQ(clock.check(12 * kSecondUs, host_us), "") << "a simulation";
  EXPECT_EQ(clock.check(host_us - 30LL * 24 * 3600 * kSecondUs, host_us), "") << "a recording of last month";
  EXPECT_EQ(clock.check(host_us - 250'000, host_us), "") << "an old sample";
  EXPECT_EQ(clock.check(host_us - 5 * kSecondUs, host_us), "") << "for a moment";
  EXPECT_EQ(clock.check(host_us - 4 * kSecondUs, host_us + kSecondUs), "");
  EXPECT_EQ(clock.check(host_us - 2 * kSecondUs, host_us + 3 * kSecondUs),
            "stamps are 5.0 s behind this host's clock (are the hosts kept in step by NTP?)");
  EXPECT_EQ(clock.check(host_us + 4 * kSecondUs, host_us + 4 * kSecondUs), "") << "in step again";
  clock.check(host_us + 20 * kSecondUs, host_us + 5 * kSecondUs);
  EXPECT_EQ(clock.check(host_us + 25 * kSecondUs, host_us + 10 * kSecondUs),
            "stamps are 15.0 s ahead of this host's clock (are the hosts kept in step by NTP?)");
  clock = {};
  for (const StampUs at_us : {0 * kSecondUs, kSecondUs, 2 * kSecondUs})
    EXPECT_EQ(clock.check(host_us + at_us - 500'000, host_us + at_us), "");
  EXPECT_THAT(clock.check(host_us + 3 * kSecondUs - 500'000, host_us + 3 * kSecondUs),
              testing::StartsWith("stamps are 0.5 s behind this host's clock"));
}

}  // namespace
}  // namespace vismem
