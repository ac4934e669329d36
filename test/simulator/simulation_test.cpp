// Motion, odometry, determinism and kidnapping of the simulated robot.
#include "simulator/core/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "simulator/core/renderer.h"
#include "simulator/corridor.h"

namespace vismem {
namespace {

using namespace test;

using namespace std::chrono_literals;

TEST(ArcMotion, QuarterCircleOfOneMetre) {
  // v = w = pi/2 for 1 s: a quarter of the circle of radius 1 about (0, 1).
  const double quarter = std::numbers::pi / 2;
  const Pose2 end = arcMotion(quarter, quarter, 1.0);
  EXPECT_NEAR(end.x, 1.0, 1e-12);
  EXPECT_NEAR(end.y, 1.0, 1e-12);
  EXPECT_NEAR(end.theta, quarter, 1e-12);
}

TEST(SimulatedBase, KeepsSpeedAndAccelerationLimits) {
  SimulatedBase base(BaseParams{}, {}, {});
  base.command(5.0, 0.0, 0);
  base.step(10'000, 0.01);
  EXPECT_NEAR(base.speed(), 0.8 * 0.01, 1e-12) << "one step of acceleration";
  for (int i = 2; i <= 200; ++i) {
    base.command(5.0, 0.0, i * 10'000);
    base.step(i * 10'000, 0.01);
    EXPECT_NEAR(base.speed(), std::min(0.6, 0.008 * i), 1e-9);
  }
}

TEST(SimulatedBase, StandsHalfASecondAfterItsCommanderVanished) {
  const BaseParams params;
  SimulatedBase base(params, {}, {});
  StampUs now = 0;
  for (; now <= 2'000'000; now += 10'000) {
    base.command(5.0, -5.0, now);
    base.step(now, 0.01);
  }
  const StampUs last_command = now - 10'000;
  ASSERT_NEAR(base.speed(), params.limits.max_speed_mps, 1e-9);
  ASSERT_NEAR(base.turnRate(), -params.limits.max_turn_rate_radps, 1e-9);
  for (; now <= last_command + 500'000; now += 10'000) base.step(now, 0.01);
  EXPECT_EQ(base.speed(), 0.0);
  EXPECT_EQ(base.turnRate(), 0.0);
}

TEST(SimulatedBase, StopsBeforeAWallAndCanTurnAndLeave) {
  Simulation simulation(inCorridor());
  ASSERT_TRUE(simulation.kidnap({-3.0, 2.25, std::numbers::pi / 2}).ok());
  drive(simulation, 5.0, 0.5, 0.0);
  EXPECT_TRUE(simulation.truth().in_collision);
  // The wall stands at y = 3, the robot's radius is 0.22 m; it stops within one step of 6 mm.
  EXPECT_NEAR(simulation.truth().T_world_robot.y, 2.78, 0.006);
  drive(simulation, 2.0, 0.0, 1.0);  // now it looks away from the wall
  drive(simulation, 1.0, 0.3, 0.0);
  EXPECT_FALSE(simulation.truth().in_collision);
  EXPECT_LT(simulation.truth().T_world_robot.y, 2.76);
}

TEST(SimulatedPanTilt, ReachesPositionsWithinItsLimitsAndRates) {
  SimulatedPanTilt unit{PanTiltParams{}};
  PanTiltCommand command;
  command.kind = PanTiltCommand::Kind::kPosition;
  command.pan_rad = degToRad(200.0);
  command.tilt_rad = degToRad(-20.0);
  unit.command(command);
  double last = 0.0;
  double fastest = 0.0;
  for (int i = 0; i < 300; ++i) {
    unit.step(0.01);
    fastest = std::max(fastest, std::abs(unit.angles().pan_rad - last) / 0.01);
    last = unit.angles().pan_rad;
    EXPECT_GE(unit.angles().tilt_rad, degToRad(-20.1)) << "no overshoot";
  }
  EXPECT_NEAR(radToDeg(unit.angles().pan_rad), 159.0, 0.01);
  EXPECT_NEAR(radToDeg(unit.angles().tilt_rad), -20.0, 0.01);
  EXPECT_LE(radToDeg(fastest), 150.0 + 1e-6);
  command.kind = PanTiltCommand::Kind::kVelocity;
  command.pan_rate_radps = 0.0;
  command.tilt_rate_radps = -1.0;
  unit.command(command);
  for (int i = 0; i < 300; ++i) unit.step(0.01);
  EXPECT_NEAR(radToDeg(unit.angles().tilt_rad), -31.0, 1e-6);
}

TEST(SimulatedPanTilt, TheHeadFollowsWhenItsMotorHasCrossedTheBacklash) {
  PanTiltParams params;
  params.backlash_rad.pan_rad = degToRad(0.4);
  SimulatedPanTilt unit{params};
  const auto lagAfter = [&](double pan_deg) {
    unit.command({PanTiltCommand::Kind::kPosition, degToRad(pan_deg), 0.1, 0.0, 0.0});
    for (int i = 0; i < 200; ++i) unit.step(0.01);
    EXPECT_NEAR(radToDeg(unit.angles().pan_rad), pan_deg, 1e-6);
    EXPECT_EQ(unit.headAngles().tilt_rad, unit.angles().tilt_rad);
    return radToDeg(unit.angles().pan_rad - unit.headAngles().pan_rad);
  };
  EXPECT_NEAR(lagAfter(10.0), 0.2, 1e-6);
  EXPECT_NEAR(lagAfter(9.9), 0.1, 1e-6) << "within the backlash the head stays";
  EXPECT_NEAR(lagAfter(5.0), -0.2, 1e-6);
}

TEST(Simulation, OdometryWithoutErrorIsTheTruth) {
  auto config = inCorridor();
  config.odometry = noOdometryError();
  Simulation simulation(config);
  drive(simulation, 8.0, 0.4, 0.0);
  drive(simulation, 2.0, 0.1, -0.7);
  const Pose2 odometry = simulation.base().samplesSince(-1, 0ms).samples.back().T_odom_robot;
  const Pose2 moved = inverse(config.start) * simulation.truth().T_world_robot;
  EXPECT_GT(moved.position().norm(), 2.0);
  EXPECT_NEAR(odometry.x, moved.x, 1e-9);
  EXPECT_NEAR(odometry.y, moved.y, 1e-9);
  EXPECT_NEAR(angleDifference(odometry.theta, moved.theta), 0.0, 1e-9);
}

TEST(Simulation, SameSeedGivesTheSameBytesAnotherSeedOtherNoiseInTheSameWorld) {
  const auto run = [](std::uint64_t seed, double noise) {
    auto config = inCorridor();
    config.seed = seed;
    config.cameras.front().errors.gaussian = noise;
    Simulation simulation(config);
    std::vector<std::uint64_t> result;
    for (int i = 0; i < 8; ++i) {
      simulation.base().setVelocity(0.4, 0.1);
      simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 0.3, -0.3, 0.0, 0.0});
      EXPECT_TRUE(simulation.advanceToNextFrame());
      const auto frame = simulation.camera().next(0ms);
      EXPECT_TRUE(frame.frame.has_value());
      if (!frame.frame) return result;
      EXPECT_EQ(frame.frame->stamp_us, i * 100'000);
      EXPECT_EQ(frame.frame->seq, static_cast<std::uint64_t>(i));
      result.push_back(hashOf(frame.frame->image));
    }
    const auto odometry = simulation.base().samplesSince(-1, 0ms).samples.back().T_odom_robot;
    result.push_back(static_cast<std::uint64_t>(odometry.x * 1e12));
    return result;
  };
  EXPECT_EQ(run(5, 2.0), run(5, 2.0));
  const auto one = run(5, 2.0);
  const auto other = run(6, 2.0);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NE(one[i], other[i]) << i;
  auto clean_one = run(5, 0.0);
  auto clean_other = run(6, 0.0);
  EXPECT_NE(clean_one.back(), clean_other.back()) << "odometry";
  clean_one.pop_back();
  clean_other.pop_back();
  EXPECT_EQ(clean_one, clean_other) << "images without noise";
}

TEST(Simulation, SamplesCoverEveryFrame) {
  Simulation simulation(inCorridor());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(simulation.advanceToNextFrame());
    const auto frame = simulation.camera().next(0ms);
    ASSERT_TRUE(frame.frame);
    EXPECT_GE(simulation.panTilt().samplesSince(-1, 0ms).samples.back().stamp_us, frame.frame->stamp_us);
    EXPECT_GE(simulation.base().samplesSince(-1, 0ms).samples.back().stamp_us, frame.frame->stamp_us);
    EXPECT_FALSE(simulation.camera().next(0ms).frame) << "one frame, taken once";
  }
}

TEST(Simulation, ReportsWhatItsCorrectionsCorrect) {
  SimulationConfig config = inCorridor();
  config.odometry = noOdometryError();
  config.cameras.front().stated_intrinsics = config.cameras.front().intrinsics;
  config.cameras.front().stated_intrinsics->fx += 7.0;
  config.joints = {1.02, 0.98, 30'000};
  config.base.wheel_base_m = 0.34;
  config.wheels = {{0.98, 1.01, 0.34}, 0.33, 50'000};
  Simulation simulation(config);
  simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 0.5, -0.3, 0.0, 0.0});
  drive(simulation, 2.0, 0.3, 0.2);
  const Pose3 T_robot_camera =
      toPose3(simulation.truth().T_world_robot).inverse() * simulation.truePoseOfCamera();
  const Eigen::Vector3d ahead = T_robot_camera.linear() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()), 1.02 * 0.5, 1e-6);
  EXPECT_NEAR(std::asin(ahead.z()), 0.98 * -0.3, 1e-6);

  const PanTiltSample joints = simulation.panTilt().samplesSince(-1, 0ms).samples.back();
  EXPECT_NEAR(joints.pan_rad, 0.5, 1e-6);
  EXPECT_EQ(joints.stamp_us, simulation.now() + 30'000);
  const auto reported = simulation.base().samplesSince(-1, 0ms).samples;
  WheelCorrection correction(config.wheels);
  OdometrySample corrected;
  for (const OdometrySample& sample : reported) corrected = correction.corrected(sample);
  const Pose2 driven = inverse(config.start) * simulation.truth().T_world_robot;
  EXPECT_EQ(corrected.stamp_us, simulation.now());
  EXPECT_NEAR((corrected.T_odom_robot.position() - driven.position()).norm(), 0.0, 1e-6);
  EXPECT_NEAR(corrected.T_odom_robot.theta, driven.theta, 1e-6);
  EXPECT_GT((reported.back().T_odom_robot.position() - driven.position()).norm(), 0.005);

  ASSERT_TRUE(simulation.advanceToNextFrame());
  EXPECT_EQ(simulation.camera().next(0ms).frame->intrinsics.fx, config.cameras.front().intrinsics.fx + 7.0);
}

TEST(Simulation, KidnapMovesTheTruthAndNotTheOdometry) {
  Simulation simulation(inCorridor());
  drive(simulation, 1.0, 0.3, 0.0);
  const Pose2 before = simulation.base().samplesSince(-1, 0ms).samples.back().T_odom_robot;
  EXPECT_TRUE(simulation.kidnap({4.2, 0.0, 1.0}).ok());
  simulation.step();
  EXPECT_EQ(simulation.truth().T_world_robot, (Pose2{4.2, 0.0, 1.0}));
  EXPECT_EQ(simulation.truth().kidnaps, 1U);
  EXPECT_EQ(simulation.base().samplesSince(-1, 0ms).samples.back().T_odom_robot, before);
  EXPECT_EQ(simulation.kidnap({0.0, 0.0, 0.0}).message, "that place is inside an obstacle");
  EXPECT_FALSE(simulation.kidnap({std::nan(""), 0.0, 0.0}).ok());
  EXPECT_EQ(simulation.truth().kidnaps, 1U);
}

TEST(Simulation, RefusesWhatIsNotFiniteAndWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Simulation simulation(inCorridor());
  EXPECT_FALSE(simulation.base().setVelocity(nan, 0.0).ok());
  EXPECT_FALSE(simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 0.0, nan, 0.0, 0.0}).ok());
  EXPECT_EQ(simulation.base().setVelocity(9.0, 0.0).kind, PortReply::Kind::kAdjusted);
  auto config = inCorridor();
  config.start = {0.0, 0.0, 0.0};
  EXPECT_THROW(Simulation{config}, std::invalid_argument);
  config = inCorridor();
  config.cameras.front().intrinsics.width = 0;
  EXPECT_THROW(Simulation{config}, std::invalid_argument);
  config = inCorridor();
  config.cameras.front().rate_hz = 0.0;
  EXPECT_THROW(Simulation{config}, std::invalid_argument);
}

TEST(Simulation, RefusesAStartThatRaysDoNotReach) {
  // Rays from such places end the renderer.
  for (const Pose2& start : {Pose2{1e300, 5.0, 0.0}, Pose2{0.0, -1e6, 0.0}, Pose2{0.0, std::nan(""), 0.0}}) {
    SimulationConfig config = inCorridor();
    config.start = start;
    EXPECT_THAT([&] { Simulation simulation(config); },
                testing::ThrowsMessage<std::invalid_argument>(
                    "the start pose is not finite, or lies more than 100 km from the origin"));
  }
}

TEST(Simulation, RemovedModelsMakeRoomForOthers) {
  const Pose3 ahead = poseFromXyzRpy(-2.0, 2.25, 0, 0, 0, 0);
  const Pose3 far_away = poseFromXyzRpy(50, 50, 0, 0, 0, 0);
  const PropShape crate{PropShape::Kind::kBox, {0.3, 0.3, 0.3}, {0.8, 0.1, 0.1}};
  const PropShape robot{PropShape::Kind::kRobot, {0.4, 0.4, 0.5}, {0.1, 0.1, 0.8}};
  const auto nextImage = [](Simulation& simulation) {
    simulation.advanceToNextFrame();
    return hashOf(simulation.takeFrame()->image);
  };
  Simulation busy(inCorridor());
  ASSERT_TRUE(busy.scene().add("stays", crate, ahead).ok());
  ASSERT_TRUE(busy.scene().add("walks", robot, far_away).ok());
  ASSERT_TRUE(busy.scene().walk("walks", {{{50, 50}, {60, 50}}, false, WayEnd::kBack, 0.5}).ok());
  for (int i = 0; i < 2500; ++i) {
    const std::string name = "visitor " + std::to_string(i);
    ASSERT_TRUE(busy.scene().add(name, i % 2 == 0 ? robot : crate, far_away).ok()) << i;
    ASSERT_TRUE(busy.scene().remove(name).ok());
  }
  EXPECT_LE(busy.scene().status().size(), corridor().models.size() + 1000);
  EXPECT_FALSE(busy.scene().find("visitor 0")) << "forgotten";
  EXPECT_TRUE(busy.scene().find("visitor 2499"));
  Simulation quiet(inCorridor());
  ASSERT_TRUE(quiet.scene().add("stays", crate, ahead).ok());
  // The first frame was exposed at time 0, before any model was added.
  nextImage(busy);
  nextImage(quiet);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(nextImage(busy), nextImage(quiet)) << i;
  const auto walker = busy.scene().find("walks");
  ASSERT_TRUE(walker);
  EXPECT_GT(busy.scene().state()->models[*walker].pose.translation().x(), 50.05);
}

}  // namespace
}  // namespace vismem
