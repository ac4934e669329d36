// What odometry does wrong all the time is learnt from trusted poses (DESIGN 9 part 3).
#include "localization/core/learnt_odometry.h"

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

/// A robot on its way, its odometry and what is learnt of it. Five poses a second, as localization tells
/// them.
class OnItsWay {
 public:
  explicit OnItsWay(std::uint64_t seed) : engine_(seed) {}

  /// One iteration of .2 s.
  void drive(double speed_mps, double turn_radps, bool trusted = true) {
    const Pose2 moved{0.2 * speed_mps, 0.0, 0.2 * turn_radps};
    T_world_robot = T_world_robot * Pose2{moved.x, 0.0, moved.theta};
    // Odometry tells so much that the truth is as the constants say, and errs by chance.
    const double way = moved.x / (1.0 + kTravelShare);
    Pose2 told{way, 0.0, (moved.theta - kTurnPerMetre * way) / (1.0 + kTurnShare)};
    told.theta += 0.01 * std::sqrt(std::abs(way)) * standardNormal(engine_);
    T_odom = T_odom * told;
    T_corrected = T_corrected * learnt.corrected(told);
    learnt.travel(told);
    if (!trusted) return learnt.lost();
    learnt.standsAt(
        {T_world_robot.x + 0.003 * standardNormal(engine_), T_world_robot.y + 0.003 * standardNormal(engine_),
         T_world_robot.theta + degToRad(0.2) * standardNormal(engine_)},
        id);
  }
  /// Straight and in curves, both ways round.
  void wander(int seconds, bool trusted = true) {
    for (int i = 0; i < 5 * seconds; ++i)
      drive(0.3, i / 20 % 3 == 0 ? 0.0 : i / 20 % 3 == 1 ? 0.8 : -0.7, trusted);
  }

  LearntOdometry learnt{LearntOdometryParams{}};
  std::uint64_t id = 1;
  Pose2 T_world_robot;
  Pose2 T_odom;
  Pose2 T_corrected;

 private:
  RandomEngine engine_;
};

TEST(LearntOdometry, BeginsAsOdometryTells) {
  const LearntOdometry learnt{LearntOdometryParams{}};
  const Pose2 moved = learnt.corrected({0.1, 0.02, 0.3});
  EXPECT_EQ(moved.x, 0.1);
  EXPECT_EQ(moved.y, 0.02);
  EXPECT_EQ(moved.theta, 0.3);
}

TEST(LearntOdometry, FindsTheErrorsAsWellAsItSays) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OnItsWay robot(seed);
    robot.wander(180);
    const OdometryBelief& belief = robot.learnt.belief();
    const Eigen::Vector3d truth(kTurnPerMetre, kTurnShare, kTravelShare);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::abs(belief.errors[i] - truth[i]), 3.0 * std::sqrt(belief.P(i, i)))
          << "error " << i << ", seed " << seed;
    }
    EXPECT_NEAR(belief.errors[0], kTurnPerMetre, 0.01);
    EXPECT_NEAR(belief.errors[1], kTurnShare, 0.015);
    EXPECT_NEAR(belief.errors[2], kTravelShare, 0.01);
    EXPECT_LT(std::sqrt(belief.P(0, 0)), 0.3 * LearntOdometryParams{}.turn_per_m);
  }
}

TEST(LearntOdometry, CorrectedOdometryGoesWhereTheRobotGoes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OnItsWay robot(seed);
    robot.wander(120);
    robot.T_odom = robot.T_corrected = robot.T_world_robot;
    // Nothing to see for 20 s.
    robot.wander(20, false);
    const auto error = [&](const Pose2& pose) {
      return std::abs(angleDifference(pose.theta, robot.T_world_robot.theta));
    };
    EXPECT_LT(error(robot.T_corrected), 0.5 * error(robot.T_odom)) << "seed " << seed;
  }
}

TEST(LearntOdometry, NothingIsLearntOfARobotThatIsCarried) {
  OnItsWay robot(1);
  robot.wander(60);
  const Eigen::Vector3d before = robot.learnt.belief().errors;
  for (int i = 0; i < 10; ++i) {
    robot.T_world_robot = {3.0 * i, -2.0, 0.3 * i};
    robot.drive(0.3, 0.0);
    robot.drive(0.3, 0.0);
  }
  EXPECT_NEAR((robot.learnt.belief().errors - before).norm(), 0.0, 1e-3);
}

TEST(LearntOdometry, NothingIsLearntFromTheJumpBetweenTwoPlaces) {
  OnItsWay robot(1);
  robot.wander(60);
  const Eigen::Vector3d before = robot.learnt.belief().errors;
  for (int i = 0; i < 20; ++i) {
    // Another race each time, 3 cm and 2 degrees aside: small enough for the gate.
    ++robot.id;
    robot.T_world_robot.x += 0.03;
    robot.T_world_robot.theta += degToRad(2.0);
    robot.drive(0.3, 0.0);
  }
  EXPECT_EQ(robot.learnt.belief().errors, before);
}

TEST(LearntOdometry, ARobotThatStandsTellsNothing) {
  OnItsWay robot(1);
  for (int i = 0; i < 500; ++i) robot.drive(0.0, 0.0);
  EXPECT_EQ(robot.learnt.belief().errors, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace vismem
