// The walk of a humanoid, and the true pose of its camera relative to its kinematics.
// Tests G1.
#include "simulator/core/humanoid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulator/core/simulation.h"
#include "simulator/corridor.h"

namespace vismem {
namespace {

using namespace test;

SimulationConfig humanoid() {
  SimulationConfig config = humanoidSimulation();
  config.world = corridor();
  config.start = {-3.0, 2.25, 0.0};
  config.cameras.front().rate_hz = 20.0;
  return config;
}

TEST(HumanoidWalk, GoesInStepsThatCoverTheWantedWay) {
  WalkParams params;
  params.step_acceleration_mps = 1.0;
  HumanoidWalk gait(params, 1);
  double way = 0.0, least = 1e9, most = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double v = gait.step({0.2, 0.0}, 0.01).v_mps;
    way += v * 0.01;
    least = std::min(least, v);
    most = std::max(most, v);
  }
  EXPECT_NEAR(way, 0.2 * 4.0, 1e-9);
  EXPECT_NEAR(least, 0.1, 0.005) << "half of the speed comes in pulses";
  EXPECT_NEAR(most, 0.3, 0.005);
}

TEST(HumanoidWalk, SpeedsUpFromStepToStepAndStopsWithOne) {
  HumanoidWalk gait(WalkParams{}, 1);
  const auto meanOfStep = [&](double wanted) {
    double way = 0.0;
    for (int i = 0; i < 25; ++i) way += gait.step({wanted, 0.0}, 0.01).v_mps * 0.01;
    return way / 0.25;
  };
  EXPECT_NEAR(meanOfStep(0.25), 0.1, 1e-9);
  EXPECT_NEAR(meanOfStep(0.25), 0.2, 1e-9);
  EXPECT_NEAR(meanOfStep(0.25), 0.25, 1e-9);
  EXPECT_NEAR(meanOfStep(0.0), 0.25, 1e-9) << "the step that was begun is done";
  EXPECT_EQ(meanOfStep(0.0), 0.0);
  EXPECT_FALSE(gait.walking());
  EXPECT_EQ(gait.posture().roll_rad, 0.0);
}

TEST(HumanoidWalk, SwaysByItsAmplitudesToBothSides) {
  WalkParams params;
  params.irregularity = 0.0;
  HumanoidWalk gait(params, 1);
  double left = 0.0, right = 0.0, forth = 0.0, back = 0.0, low = 0.0;
  BodyPosture last;
  for (int i = 0; i < 400; ++i) {
    gait.step({0.2, 0.0}, 0.01);
    const BodyPosture now = gait.posture();
    left = std::min(left, now.roll_rad);
    right = std::max(right, now.roll_rad);
    forth = std::max(forth, now.pitch_rad);
    back = std::min(back, now.pitch_rad);
    low = std::min(low, now.height_m);
    EXPECT_LT(std::abs(now.roll_rad - last.roll_rad), degToRad(0.2)) << "without jumps";
    EXPECT_LT(std::abs(now.pitch_rad - last.pitch_rad), degToRad(0.4));
    last = now;
  }
  for (const double extreme : {-left, right, forth, -back}) EXPECT_NEAR(radToDeg(extreme), 1.0, 0.02);
  EXPECT_NEAR(low, -0.005, 1e-4);
}

TEST(Humanoid, StandsWithinHalfASecondWhenItsCommanderVanishes) {
  Simulation simulation(humanoid());
  drive(simulation, 3.0, 0.25, 0.5);
  EXPECT_GT(simulation.truth().T_world_robot.x, -2.9);
  simulation.advance(500'000);
  const Pose2 there = simulation.truth().T_world_robot;
  simulation.advance(1'000'000);
  EXPECT_EQ(simulation.truth().T_world_robot, there);
}

TEST(Humanoid, NeckKeepsToItsLimits) {
  Simulation simulation(humanoid());
  const auto reply = simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 3.0, -3.0, 0.0, 0.0});
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  simulation.advance(3'000'000);
  const auto angles = simulation.panTilt().samplesSince(-1, std::chrono::milliseconds(0)).samples.back();
  EXPECT_NEAR(radToDeg(angles.pan_rad), 119.5, 1e-3);
  EXPECT_NEAR(radToDeg(angles.tilt_rad), -29.5, 1e-3);
}

TEST(Humanoid, StandingItBelievesWhereItsCameraIs) {
  Simulation simulation(humanoid());
  simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 0.4, -0.2, 0.0, 0.0});
  simulation.advance(2'000'000);
  const auto frame = simulation.takeFrame();
  ASSERT_TRUE(frame && frame->T_robot_camera);
  const Pose3 believed = toPose3(simulation.truth().T_world_robot) * *frame->T_robot_camera;
  EXPECT_TRUE(believed.isApprox(simulation.truePoseOfCamera(), 1e-9));
  EXPECT_NEAR(frame->T_robot_camera->translation().z(), 0.45, 0.02);
  EXPECT_TRUE(simulation.camera().capabilities().knows_camera_pose);
}

/// Largest angles between the true camera and the believed one over a walk, about the robot's axes [deg].
Eigen::Vector3d worstAngles(SimulationConfig config) {
  Simulation simulation(std::move(config));
  simulation.takeFrame();  // of time 0
  Eigen::Vector3d worst = Eigen::Vector3d::Zero();
  for (int i = 0; i < 400; ++i) {
    simulation.base().setVelocity(0.2, 0.0);
    simulation.step();
    const auto frame = simulation.takeFrame();
    if (!frame) continue;
    // Frames at 20 Hz are exposed at the end of a step of the simulation: the true pose now is the frame's.
    const Eigen::Matrix3d R = (toPose3(simulation.truth().T_world_robot) * *frame->T_robot_camera).linear();
    const Eigen::Matrix3d turn = simulation.truePoseOfCamera().linear() * R.transpose();
    const Eigen::AngleAxisd angle(turn);
    worst = worst.cwiseMax((angle.angle() * angle.axis()).cwiseAbs());
  }
  return worst * radToDeg(1.0);
}

TEST(Humanoid, WalkingItsCameraSwaysBesideWhatItBelieves) {
  auto config = humanoid();
  config.walk->irregularity = 0.0;
  const Eigen::Vector3d unknown = worstAngles(config);
  EXPECT_NEAR(unknown.x(), 1.0, 0.1);
  EXPECT_NEAR(unknown.y(), 1.0, 0.1);
  config.walk->known = 0.75;
  const Eigen::Vector3d known = worstAngles(config);
  EXPECT_NEAR(known.x(), 0.25, 0.03);
  config.walk->known = 1.0;
  EXPECT_LT(worstAngles(config).maxCoeff(), 1e-5);
}

TEST(Humanoid, ACalibrationErrorTurnsTheTrueCameraOnly) {
  auto config = humanoid();
  config.cameras.front().T_believed_true = poseFromXyzRpy(0, 0, 0, 0, degToRad(0.5), 0);
  Simulation simulation(config);
  const auto frame = simulation.takeFrame();
  const Pose3 believed = toPose3(config.start) * *frame->T_robot_camera;
  const Eigen::Vector3d ahead = simulation.truePoseOfCamera().linear() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(radToDeg(std::asin(-ahead.z())), 0.5, 1e-6) << "looks down by what is not known";
  EXPECT_NEAR((believed.linear() * Eigen::Vector3d::UnitZ()).z(), 0.0, 1e-9);
}

}  // namespace
}  // namespace vismem
