#include "calibration/core/odometry/wheel_path.h"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

/// A drive as an odometry of base 0.33 m reports it, at 50 Hz.
std::vector<OdometrySample> drive() {
  std::vector<OdometrySample> samples;
  Pose2 pose;
  for (int i = 0; i <= 500; ++i) {
    const double v = i < 200 ? 0.3 : i < 300 ? 0.0 : -0.2;
    const double w = i < 200 ? 0.2 : i < 300 ? 1.0 : 0.1;
    samples.push_back({i * 20'000, static_cast<std::uint64_t>(i), pose, v, w});
    pose = pose * arcMotion(v, w, 0.02);
  }
  return samples;
}

TEST(WheelPath, GivesBackTheMotionOfTheOdometryItself) {
  const auto samples = drive();
  const WheelPath path(samples, 0.33);
  const Eigen::Vector3d motion = path.motion<double>(1.0, 1.0, 0.33, 1.0, 9.0, 1.0, 9.0);
  const Pose2 expected = inverse(samples[50].T_odom_robot) * samples[450].T_odom_robot;
  EXPECT_NEAR(motion.x(), expected.x, 1e-9);
  EXPECT_NEAR(motion.y(), expected.y, 1e-9);
  EXPECT_NEAR(angleDifference(motion.z(), expected.theta), 0.0, 1e-9);
}

// Any base that stands for the unknown one of the odometry gives the same motions once the model is scaled
// with it: here twice the base, with the turn in the same ratio.
TEST(WheelPath, AnotherAssumedBaseIsAnotherNameForTheSameMotion) {
  const auto samples = drive();
  const WheelPath path(samples, 0.66);
  const Eigen::Vector3d motion = path.motion<double>(1.0, 1.0, 0.66, 0.0, 10.0, 0.0, 10.0);
  const Pose2 expected = inverse(samples.front().T_odom_robot) * samples.back().T_odom_robot;
  EXPECT_NEAR(motion.x(), expected.x, 1e-9);
  EXPECT_NEAR(motion.y(), expected.y, 1e-9);
}

TEST(WheelPath, CovarianceIsThatOfManyNoisyDrives) {
  const auto samples = drive();
  const WheelPath path(samples, 0.33);
  const double sigma = 0.003;
  const Eigen::Matrix3d P = path.covariance({1.0, 1.0, 0.33}, 0.0, 10.0, sigma);
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  constexpr int kDrives = 2000;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  const Eigen::Vector3d mean = path.motion<double>(1.0, 1.0, 0.33, 0.0, 10.0, 0.0, 10.0);
  for (int n = 0; n < kDrives; ++n) {
    Eigen::Vector3d pose = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double dt = 0.02;
      const double v = samples[i - 1].v_mps;
      const double w = samples[i - 1].w_radps;
      const auto noisy = [&](double travel) {
        return travel + sigma * std::sqrt(std::abs(travel)) * normal(engine);
      };
      const double left = noisy((v - 0.165 * w) * dt);
      const double right = noisy((v + 0.165 * w) * dt);
      pose = advanced<double>(pose, 0.5 * (left + right), (right - left) / 0.33);
    }
    scatter += (pose - mean) * (pose - mean).transpose() / kDrives;
  }
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(scatter(i, i) / P(i, i), 1.0, 0.12) << i;
}

TEST(WheelPath, ReportsSpeedAndTravel) {
  const WheelPath path(drive(), 0.33);
  EXPECT_NEAR(path.speedAt(1.0).left, 0.3 - 0.165 * 0.2, 1e-9);
  EXPECT_NEAR(path.travelled(4.0, 6.0).right, 2.0 * 0.165, 1e-9) << "two seconds of turning at 1 rad/s";
}

}  // namespace
}  // namespace vismem
