// Tests L2: odometry is calibrated by trusted poses.
#include "localization/core/odometry_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "experiments/trials/gaussian.h"

namespace vismem {
namespace {

constexpr double kTurnPerMetre = 0.04;
constexpr double kTurnShare = -0.03;
constexpr double kTravelShare = 0.02;

/// A moving robot with biased odometry, and its calibration. Five poses per second.
class DrivenRobot {
 public:
  explicit DrivenRobot(std::uint64_t seed) : engine_(seed) {}

  /// One iteration of 0.2 s.
  void drive(double speed_mps, double turn_radps, bool trusted = true) {
    const Pose2 moved{0.2 * speed_mps, 0.0, 0.2 * turn_radps};
    T_world_robot = T_world_robot * Pose2{moved.x, 0.0, moved.theta};
    // Odometry with the errors of the constants plus noise.
    const double way = moved.x / (1.0 + kTravelShare);
    Pose2 reported{way, 0.0, (moved.theta - kTurnPerMetre * way) / (1.0 + kTurnShare)};
    reported.theta += 0.01 * std::sqrt(std::abs(way)) * standardNormal(engine_);
    T_odom = T_odom * reported;
    T_corrected = T_corrected * calibration.corrected(reported);
    calibration.addMotion(reported);
    if (!trusted) return calibration.interrupt();
    calibration.addReferencePose(
        {T_world_robot.x + 0.003 * standardNormal(engine_), T_world_robot.y + 0.003 * standardNormal(engine_),
         T_world_robot.theta + degToRad(0.2) * standardNormal(engine_)},
        id);
  }
  /// Straight parts and curves in both directions.
  void wander(int seconds, bool trusted = true) {
    for (int i = 0; i < 5 * seconds; ++i)
      drive(0.3, i / 20 % 3 == 0 ? 0.0 : i / 20 % 3 == 1 ? 0.8 : -0.7, trusted);
  }

  OdometryCalibration calibration{OdometryCalibrationParams{}};
  std::uint64_t id = 1;
  Pose2 T_world_robot;
  Pose2 T_odom;
  Pose2 T_corrected;

 private:
  RandomEngine engine_;
};

TEST(OdometryCalibration, StartsWithoutCorrection) {
  const OdometryCalibration calibration{OdometryCalibrationParams{}};
  const Pose2 moved = calibration.corrected({0.1, 0.02, 0.3});
  EXPECT_EQ(moved.x, 0.1);
  EXPECT_EQ(moved.y, 0.02);
  EXPECT_EQ(moved.theta, 0.3);
}

TEST(OdometryCalibration, FindsTheErrorsWithinItsCovariance) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    DrivenRobot robot(seed);
    robot.wander(180);
    const OdometryBias& bias = robot.calibration.bias();
    const Eigen::Vector2d truth(kTurnPerMetre, kTurnShare);
    for (int i = 0; i < 2; ++i) {
      EXPECT_LT(std::abs(bias.errors[i] - truth[i]), 3.0 * std::sqrt(bias.P(i, i)))
          << "error " << i << ", seed " << seed;
    }
    EXPECT_NEAR(bias.errors[0], kTurnPerMetre, 0.01);
    EXPECT_NEAR(bias.errors[1], kTurnShare, 0.015);
    EXPECT_EQ(bias.errors[2], 0.0) << "a state of each race";
    EXPECT_LT(std::sqrt(bias.P(0, 0)), 0.3 * OdometryCalibrationParams{}.turn_per_m);
  }
}

TEST(OdometryCalibration, CorrectedOdometryDriftsLess) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    DrivenRobot robot(seed);
    robot.wander(120);
    robot.T_odom = robot.T_corrected = robot.T_world_robot;
    // 20 s without trusted poses.
    robot.wander(20, false);
    const auto error = [&](const Pose2& pose) {
      return std::abs(angleDifference(pose.theta, robot.T_world_robot.theta));
    };
    EXPECT_LT(error(robot.T_corrected), 0.5 * error(robot.T_odom)) << "seed " << seed;
  }
}

TEST(OdometryCalibration, ACarriedRobotChangesNothing) {
  DrivenRobot robot(1);
  robot.wander(60);
  const Eigen::Vector3d before = robot.calibration.bias().errors;
  for (int i = 0; i < 10; ++i) {
    robot.T_world_robot = {3.0 * i, -2.0, 0.3 * i};
    robot.drive(0.3, 0.0);
    robot.drive(0.3, 0.0);
  }
  EXPECT_NEAR((robot.calibration.bias().errors - before).norm(), 0.0, 1e-3);
}

TEST(OdometryCalibration, AChangeOfTheRaceChangesNothing) {
  DrivenRobot robot(1);
  robot.wander(60);
  const Eigen::Vector3d before = robot.calibration.bias().errors;
  for (int i = 0; i < 20; ++i) {
    // Another race each time, off by 3 cm and 2 degrees: small enough for the gate.
    ++robot.id;
    robot.T_world_robot.x += 0.03;
    robot.T_world_robot.theta += degToRad(2.0);
    robot.drive(0.3, 0.0);
  }
  EXPECT_EQ(robot.calibration.bias().errors, before);
}

TEST(OdometryCalibration, AStandingRobotChangesNothing) {
  DrivenRobot robot(1);
  for (int i = 0; i < 500; ++i) robot.drive(0.0, 0.0);
  EXPECT_EQ(robot.calibration.bias().errors, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace vismem
