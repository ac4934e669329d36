#include "evaluation/app/mirrored_robot.h"

#include <gtest/gtest.h>

#include <limits>

#include "simulator/core/simulation.h"

namespace vismem {
namespace {

constexpr StampUs kFirst_us = std::numeric_limits<StampUs>::min() / 2;

SimulationConfig emptyWorld(float light) {
  SimulationConfig config;
  config.seed = 5;
  config.world.ambient.setConstant(light);
  return config;
}

TEST(MirroredRobot, DoesToItsDoubleWhatIsDoneToIt) {
  Simulation robot(emptyWorld(1.0F));
  Simulation mirror(emptyWorld(0.5F));
  MirroredRobot both(robot, mirror);
  both.panTilt().command({PanTiltCommand::Kind::kVelocity, 0.0, 0.0, 0.5, -0.2});
  for (int i = 0; i < 10; ++i) {
    both.base().setVelocity(0.2, 0.1);
    ASSERT_TRUE(both.advanceToNextFrame());
    const FrameResult seen = both.camera().next(std::chrono::milliseconds(0));
    ASSERT_TRUE(seen.frame);
    EXPECT_FALSE(mirror.frameDue()) << "the double's image was not read";
  }
  EXPECT_EQ(mirror.truth().T_world_robot, robot.truth().T_world_robot);
  EXPECT_GT(robot.truth().T_world_robot.position().norm(), 0.01);
  const auto samples = both.panTilt().samplesSince(kFirst_us, std::chrono::milliseconds(0)).samples;
  const auto mirrored = mirror.panTilt().samplesSince(kFirst_us, std::chrono::milliseconds(0)).samples;
  ASSERT_FALSE(samples.empty());
  ASSERT_EQ(mirrored.size(), samples.size());
  EXPECT_EQ(mirrored.back().pan_rad, samples.back().pan_rad);
  EXPECT_GT(samples.back().pan_rad, 0.01);
}

}  // namespace
}  // namespace vismem
