#include "common/kinematics/wheel_correction.h"

#include <gtest/gtest.h>

#include "common/kinematics/calibrated_ports.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

std::vector<OdometrySample> straight(int steps) {
  std::vector<OdometrySample> samples;
  for (int i = 0; i <= steps; ++i) {
    samples.push_back({i * 10'000, static_cast<std::uint64_t>(i), {0.01 * i, 0.0, 0.0}, 1.0, 0.0});
  }
  return samples;
}

// 1 m straight on with wheels 1 % and 2 % larger at a base of 0.5 m: 1.015 m, and 0.01 / 0.5 = 0.02 rad.
TEST(WheelCorrection, OtherWheelsDriveAnotherWay) {
  WheelCorrection correction({{1.01, 1.02, 0.5}, 0.33, 40'000});
  OdometrySample last;
  for (const auto& sample : straight(100)) last = correction.corrected(sample);
  EXPECT_NEAR(last.T_odom_robot.theta, 0.02, 1e-12);
  EXPECT_NEAR(last.T_odom_robot.x, 1.015 * (1.0 - 0.02 * 0.02 / 6.0), 1e-6);
  EXPECT_NEAR(last.T_odom_robot.y, 0.5 * 1.015 * 0.02, 1e-6);
  EXPECT_NEAR(last.v_mps, 1.015, 1e-12);
  EXPECT_NEAR(last.w_radps, 0.02, 1e-12);
  EXPECT_EQ(last.stamp_us, 1'000'000 - 40'000);
}

TEST(WheelCorrection, WithoutErrorsItChangesNothing) {
  WheelCorrection correction({{1.0, 1.0, 0.33 * (1.0 + 1e-15)}, 0.33, 0});
  EXPECT_TRUE((WheelCorrectionParams{{1.0, 1.0, 0.4}, 0.4, 10}.hasReportedWheels()));
  Pose2 pose{1.0, -2.0, 0.5};
  for (int i = 0; i < 300; ++i) {
    pose = pose * arcMotion(i < 200 ? 0.3 : -0.2, 0.8, 0.02);
    const OdometrySample sample{i * 20'000, static_cast<std::uint64_t>(i), pose, 0.3, 0.8};
    const OdometrySample same = correction.corrected(sample);
    ASSERT_NEAR(same.T_odom_robot.x, pose.x, 1e-9);
    ASSERT_NEAR(same.T_odom_robot.y, pose.y, 1e-9);
    ASSERT_NEAR(same.T_odom_robot.theta, pose.theta, 1e-9);
    ASSERT_NEAR(same.w_radps, 0.8, 1e-12);
  }
}

TEST(WheelCorrection, BeginsAnewWhenTheOdometryRestarts) {
  WheelCorrection correction({{1.1, 1.1, 0.33}, 0.33, 0});
  for (const auto& sample : straight(10)) correction.corrected(sample);
  const OdometrySample restarted = correction.corrected({200'000, 0, {5.0, 1.0, 0.0}, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(restarted.T_odom_robot.x, 5.0);
}

/// Keeps the last command.
class StillUnit : public PanTiltUnit {
 public:
  PanTiltLimits limits() const override { return {-2.0, 2.0, -0.5, 0.5, 1.0, 1.0}; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply command(const PanTiltCommand& c) override {
    last = c;
    return PortReply::accepted();
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    asked_us = after_us;
    return {SourceState::kRunning, {{1'000'000, 1, 0.5, -0.2}}, ""};
  }
  void stop() override {}
  PanTiltCommand last;
  StampUs asked_us = 0;
};

TEST(CalibratedPanTilt, ScalesReadingsAndCommandsAndShiftsStamps) {
  StillUnit unit;
  CalibratedPanTilt calibrated(unit, {1.02, 0.98, 30'000});
  const auto sample = calibrated.samplesSince(500'000, std::chrono::milliseconds(0)).samples.at(0);
  EXPECT_EQ(unit.asked_us, 530'000);
  EXPECT_EQ(sample.stamp_us, 970'000);
  EXPECT_DOUBLE_EQ(sample.pan_rad, 0.51);
  EXPECT_DOUBLE_EQ(sample.tilt_rad, -0.196);
  calibrated.command({PanTiltCommand::Kind::kPosition, 0.51, -0.196, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(unit.last.pan_rad, 0.5);
  EXPECT_DOUBLE_EQ(unit.last.tilt_rad, -0.2);
  EXPECT_DOUBLE_EQ(calibrated.limits().max_pan_rad, 2.04);
}

}  // namespace
}  // namespace vismem
