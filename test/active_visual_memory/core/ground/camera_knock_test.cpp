#include "active_visual_memory/core/ground/camera_knock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"

namespace vismem {
namespace {

constexpr double kDeg = degToRad(1.0);

// The four errors on a camera that looks straight ahead, against its true elevation and roll.
TEST(CameraKnock, SumsMountAndCameraAsTheCameraTurns) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  const CameraTilt tilt(0.3 * kDeg, -0.5 * kDeg, 0.4 * kDeg, 0.2 * kDeg);
  const Pose3 pose = tilted(cameraPose(mount, 0.0, 0.0), tilt);
  const double elevation = std::asin(pose.linear()(2, 2));
  const double roll = std::asin(-pose.linear()(2, 0));
  const CameraKnock knock = knockOf(tilt, CameraTiltCovariance::Identity() * kDeg * kDeg * 0.01);
  EXPECT_NEAR(knock.angle_rad, std::hypot(elevation, roll), 0.01 * kDeg);
  EXPECT_NEAR(knock.angle_rad, std::hypot(0.9, 0.5) * kDeg, 1e-9);
  EXPECT_NEAR(knock.sigma_rad, 0.1 * std::sqrt(2.0) * kDeg, 1e-9);
}

// Only the difference of the two pitch errors is known: the sum's deviation is small, the parts' is not.
TEST(CameraKnock, IsKnownBetterThanItsParts) {
  CameraTiltCovariance P = CameraTiltCovariance::Identity() * 1e-8;
  P.block<2, 2>(1, 1) << 1e-4, 1e-4, 1e-4, 1e-4;
  P.diagonal().array() += 1e-8;
  EXPECT_LT(knockOf({0.0, -0.01, 0.005, 0.0}, P).sigma_rad, 3e-4);
  EXPECT_GT(knockOf(CameraTilt::Zero(), P).sigma_rad, 0.0);
}

TEST(KnockAlarm, SpeaksOnceBeyondThreeSigmasAndOnceWhenItIsOver) {
  KnockAlarm alarm(0.05 * kDeg);
  EXPECT_EQ(alarm.update({0.1 * kDeg, 0.05 * kDeg}), "");
  EXPECT_EQ(alarm.update({0.8 * kDeg, 0.05 * kDeg}),
            "the camera was knocked by 0.8 degrees (11.3 standard deviations): run calibrate body");
  EXPECT_EQ(alarm.update({0.8 * kDeg, 0.05 * kDeg}), "");
  EXPECT_EQ(alarm.update({0.18 * kDeg, 0.05 * kDeg}), "") << "between 2 and 3 it stays";
  EXPECT_TRUE(alarm.isOn());
  EXPECT_THAT(alarm.update({0.1 * kDeg, 0.05 * kDeg}), testing::HasSubstr("as it was calibrated again"));
}

TEST(KnockAlarm, IsSilentOnARobotThatWasNeverCalibrated) {
  KnockAlarm alarm(0.0);
  EXPECT_EQ(alarm.update({2.0 * kDeg, 0.01 * kDeg}), "");
  EXPECT_FALSE(alarm.isOn());
}

}  // namespace
}  // namespace vismem
