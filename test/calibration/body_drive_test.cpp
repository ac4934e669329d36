#include "calibration/core/body/body_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

constexpr double kStep_s = 0.02;

/// A perfect robot that sees the board whenever a view is taken while it may.
class PerfectRobot {
 public:
  PerfectRobot(const BodyDriveParams& params, const Eigen::Vector2d& board)
      : drive(params), head_(PanTiltParams{}), board_(board) {}

  void step() {
    const BodyDriveCommand command = drive.update({now_us, head_.angles(), pose});
    if (command.head) head_.command(*command.head);
    if (command.take_view && sees) drive.seen(now_us, {board_.x(), board_.y(), 0.0});
    if (command.take_view) ++views;
    pose = pose * arcMotion(command.v_mps, command.w_radps, kStep_s);
    head_.step(kStep_s);
    now_us += toStampUs(kStep_s);
    farthest = std::max(farthest, (pose.position() - board_).norm());
    nearest = std::min(nearest, (pose.position() - board_).norm());
    moving = command.v_mps != 0.0 || command.w_radps != 0.0;
  }
  /// @return whether it ended within ten minutes.
  bool finish() {
    while (toSeconds(now_us) < 600.0) {
      if (drive.phase() == BodyDrivePhase::kDone || drive.phase() == BodyDrivePhase::kStopped) return true;
      step();
    }
    return false;
  }
  void untilPhase(BodyDrivePhase phase) {
    while (toSeconds(now_us) < 600.0 && drive.phase() != phase) step();
  }

  BodyDrive drive;
  Pose2 pose;
  StampUs now_us = 0;
  bool sees = true;
  bool moving = false;
  int views = 0;
  double farthest = 0.0;
  double nearest = 1e9;

 private:
  SimulatedPanTilt head_;
  Eigen::Vector2d board_;
};

BodyDriveParams params() {
  BodyDriveParams p;
  p.rig.mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  p.fence_m = 1.5;
  return p;
}

TEST(BodyDrive, LooksFromAllAroundWithinItsFenceAndOffTheBoard) {
  PerfectRobot robot(params(), {1.2, 0.3});
  ASSERT_TRUE(robot.finish());
  EXPECT_EQ(robot.drive.phase(), BodyDrivePhase::kDone) << robot.drive.whyStopped();
  EXPECT_EQ(robot.drive.stepsDone(), robot.drive.steps());
  EXPECT_LT(robot.farthest, params().fence_m);
  EXPECT_GT(robot.nearest, params().robot_radius_m + params().board_radius_m);
  EXPECT_GT(robot.views, 150);
  robot.step();
  EXPECT_FALSE(robot.moving);
}

TEST(BodyDrive, StopsBeyondItsFence) {
  PerfectRobot robot(params(), {1.2, 0.3});
  robot.untilPhase(BodyDrivePhase::kRing);
  robot.pose = robot.pose * Pose2{-1.5, 0.0, 0.0};
  robot.step();
  EXPECT_EQ(robot.drive.phase(), BodyDrivePhase::kStopped);
  EXPECT_THAT(robot.drive.whyStopped(), testing::HasSubstr("beyond the fence at 1.5 m"));
  EXPECT_FALSE(robot.moving);
}

TEST(BodyDrive, StandsAndLooksForABoardThatItLost) {
  PerfectRobot robot(params(), {1.2, 0.3});
  robot.untilPhase(BodyDrivePhase::kTurns);
  robot.sees = false;
  robot.untilPhase(BodyDrivePhase::kSearch);
  for (int i = 0; i < 100; ++i) {
    robot.step();
    ASSERT_FALSE(robot.moving);
  }
  robot.sees = true;
  ASSERT_TRUE(robot.finish());
  EXPECT_EQ(robot.drive.phase(), BodyDrivePhase::kDone) << robot.drive.whyStopped();
}

TEST(BodyDrive, StopsWhenTheBoardStaysAway) {
  PerfectRobot robot(params(), {1.2, 0.3});
  robot.untilPhase(BodyDrivePhase::kTurns);
  robot.sees = false;
  ASSERT_TRUE(robot.finish());
  EXPECT_EQ(robot.drive.phase(), BodyDrivePhase::kStopped);
  EXPECT_THAT(robot.drive.whyStopped(), testing::HasSubstr("the board was not found"));
}

TEST(BodyDrive, NeverMovesItsBaseBeforeTheBoardWasFound) {
  PerfectRobot robot(params(), {1.2, 0.3});
  robot.sees = false;
  while (robot.drive.phase() == BodyDrivePhase::kSearch) {
    robot.step();
    ASSERT_FALSE(robot.moving);
  }
  EXPECT_THAT(robot.drive.whyStopped(), testing::HasSubstr("the board was not found"));
}

TEST(BodyDrive, StopsWhenAsked) {
  PerfectRobot robot(params(), {1.2, 0.3});
  robot.untilPhase(BodyDrivePhase::kRing);
  robot.drive.stop("asked to");
  robot.step();
  EXPECT_FALSE(robot.moving);
  EXPECT_EQ(robot.drive.whyStopped(), "asked to");
}

TEST(BodyDrive, NamesAFenceThatIsTooNear) {
  BodyDriveParams p = params();
  EXPECT_EQ(checkBodyDrive(p), "");
  p.fence_m = 1.2;
  EXPECT_THAT(checkBodyDrive(p), testing::HasSubstr("fence at 1.2 m (must be at least 1.25"));
  p.fence_m = 2.0;
  p.ring_m = 0.4;
  EXPECT_THAT(checkBodyDrive(p), testing::HasSubstr("drive over it"));
}

}  // namespace
}  // namespace vismem
