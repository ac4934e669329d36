// Units of common/robot: histories that interpolate and the assembler of observations (SPEC G3).
#include <gtest/gtest.h>

#include "common/robot/observation.h"

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

}  // namespace
}  // namespace vismem
