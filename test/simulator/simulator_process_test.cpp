// The process simulator over Ice: its ports, kidnapping, pausing, and its messages.
// Tests C2.
#include <Ice/Ice.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>

#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "support/build_paths.h"
#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::string kConfig = "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/sim/simulator.cfg";
const std::string kWorld = "--Simulator.World=" VISMEM_SOURCE_DIR "/cfg/worlds/corridor.world";
const std::string kEndpoint = "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0";

TEST(SimulatorProcess, ServesARobotThatSeesMovesAndCanBeKidnapped) {
  ComponentProcess process("simulator", {kConfig, kWorld, kEndpoint});
  ASSERT_TRUE(process.waitUntilReady());
  Ice::CommunicatorHolder ice(Ice::initialize());
  const auto proxy = [&](const std::string& identity) { return ice->stringToProxy(process.proxy(identity)); };
  RemoteFrameSource camera(Ice::uncheckedCast<avm::CameraPrx>(proxy("cameraA")));
  RemotePanTiltUnit pan_tilt(Ice::uncheckedCast<avm::PanTiltPrx>(proxy("PanTilt")));
  RemoteMobileBase base(Ice::uncheckedCast<avm::BasePrx>(proxy("Motors")),
                        Ice::uncheckedCast<avm::OdometryPrx>(proxy("Encoders")));
  RemoteSimulation simulation(Ice::uncheckedCast<avm::SimulationPrx>(proxy("Simulation")));

  FrameResult first;
  ASSERT_TRUE(eventually([&] { return (first = camera.next(500ms)).frame.has_value(); })) << first.message;
  EXPECT_EQ(first.frame->image.cols, 320);
  EXPECT_EQ(first.frame->image.rows, 240);
  FrameResult second;
  ASSERT_TRUE(eventually([&] { return (second = camera.next(500ms)).frame.has_value(); }));
  EXPECT_GT(second.frame->stamp_us, first.frame->stamp_us);

  ASSERT_TRUE(pan_tilt.command({PanTiltCommand::Kind::kPosition, 0.5, -0.3, 0.0, 0.0}).ok());
  EXPECT_TRUE(eventually([&] {
    const auto batch = pan_tilt.samplesSince(-1, 500ms);
    return !batch.samples.empty() && std::abs(batch.samples.back().pan_rad - 0.5) < 1e-3;
  }));
  EXPECT_TRUE(eventually([&] {
    EXPECT_TRUE(base.setVelocity(0.3, 0.0).ok());
    const auto batch = base.samplesSince(-1, 500ms);
    return !batch.samples.empty() && batch.samples.back().T_odom_robot.x > 0.05;
  }));

  EXPECT_FALSE(simulation.kidnap({0.0, 0.0, 0.0}).ok()) << "inside the core";
  ASSERT_TRUE(simulation.kidnap({4.25, 0.0, 1.0}).ok());
  EXPECT_TRUE(eventually([&] {
    const auto truth = simulation.truthSince(-1, 500ms);
    return !truth.samples.empty() && truth.samples.back().kidnaps == 1 &&
           std::abs(truth.samples.back().T_world_robot.x - 4.25) < 0.5;
  }));

  ASSERT_TRUE(simulation.pause().ok());
  const auto paused = simulation.status();
  EXPECT_TRUE(paused.paused);
  EXPECT_EQ(paused.world, "corridor");
  EXPECT_EQ(simulation.status().stamp_us, paused.stamp_us);
  EXPECT_FALSE(simulation.setSpeed(0.0).ok());
  EXPECT_TRUE(simulation.resume().ok());
  EXPECT_TRUE(eventually([&] { return simulation.status().stamp_us > paused.stamp_us; }));

  ASSERT_TRUE(process.signal(SIGTERM));
  EXPECT_EQ(process.waitForExit(kPatience), 0) << process.error();
}

TEST(SimulatorProcess, InLockStepTimeWaitsForWhoTakesImages) {
  ComponentProcess process("simulator", {kConfig, kWorld, kEndpoint, "--Simulator.LockStep=1",
                                         "--Simulator.RenderThreads=2", "--Simulator.Camera.Rate_hz=10"});
  ASSERT_TRUE(process.waitUntilReady());
  Ice::CommunicatorHolder ice(Ice::initialize());
  const auto proxy = [&](const std::string& identity) { return ice->stringToProxy(process.proxy(identity)); };
  const auto camera = Ice::uncheckedCast<avm::CameraPrx>(proxy("cameraA"));
  RemoteSimulation simulation(Ice::uncheckedCast<avm::SimulationPrx>(proxy("Simulation")));
  EXPECT_EQ(simulation.status().lock_step, 1);
  Ice::Long seq = -1;
  Ice::Long last_us = -1;
  for (int i = 0; i < 30; ++i) {
    const auto frame = camera->getNext("RGB8", seq);
    ASSERT_EQ(frame.state, avm::SourceState::Running) << frame.message;
    EXPECT_EQ(frame.image.seq, seq + 1) << "none is left out, however fast they come";
    if (i > 0) {
      EXPECT_EQ(frame.image.stampUs, last_us + 100'000);
    }
    seq = frame.image.seq;
    last_us = frame.image.stampUs;
    // Without a waiting client, time stands at this image.
    EXPECT_EQ(simulation.status().stamp_us, last_us);
  }
  ASSERT_TRUE(simulation.setLockStep(0).ok());
  EXPECT_TRUE(eventually([&] { return simulation.status().stamp_us > last_us + 100'000; }));
}

TEST(SimulatorProcess, InLockStepTheNextImageComesWhenTheLastConsumerAsks) {
  ComponentProcess process(
      "simulator", {kConfig, kWorld, kEndpoint, "--Simulator.LockStep=2", "--Simulator.Camera.Rate_hz=10",
                    "--Simulator.Camera.Width_px=64", "--Simulator.Camera.Height_px=48"});
  ASSERT_TRUE(process.waitUntilReady());
  Ice::CommunicatorHolder ice(Ice::initialize());
  const auto camera = Ice::uncheckedCast<avm::CameraPrx>(ice->stringToProxy(process.proxy("cameraA")));
  Ice::Long seq = -1;
  auto shortest = std::chrono::steady_clock::duration::max();
  for (int i = 0; i < 20; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    auto first = camera->getNextAsync("RGB8", seq);
    const auto frame = camera->getNext("GRAY8", seq);
    ASSERT_EQ(frame.state, avm::SourceState::Running) << frame.message;
    ASSERT_EQ(first.get().image.seq, frame.image.seq);
    seq = frame.image.seq;
    shortest = std::min(shortest, std::chrono::steady_clock::now() - begin);
  }
  // The simulator looks ten times a second by itself.
  EXPECT_LT(shortest, 50ms);
}

TEST(SimulatorProcess, ShowsTruthBesideImagesAndStartsAgainWhenReset) {
  ComponentProcess process(
      "simulator", {kConfig, kWorld, kEndpoint, "--Simulator.Paused=yes", "--Simulator.Camera.Depth=yes",
                    "--Simulator.Camera.Objects=yes", "--Simulator.Cameras.cameraB.Position_m=0 -0.1 0"});
  ASSERT_TRUE(process.waitUntilReady());
  Ice::CommunicatorHolder ice(Ice::initialize());
  const auto proxy = [&](const std::string& identity) { return ice->stringToProxy(process.proxy(identity)); };
  RemoteSimulation simulation(Ice::uncheckedCast<avm::SimulationPrx>(proxy("Simulation")));
  for (const std::string name : {"cameraA", "cameraA/depth", "cameraA/objects", "cameraB"}) {
    const auto frame = Ice::uncheckedCast<avm::CameraPrx>(proxy(name))->getNext("RGB8", -1);
    ASSERT_EQ(frame.state, avm::SourceState::Running) << name << ": " << frame.message;
    EXPECT_EQ(frame.image.stampUs, 0) << name;
    EXPECT_EQ(frame.image.pixels.size(), 320U * 240U * 3U);
  }
  EXPECT_THAT(simulation.models(), testing::SizeIs(testing::Gt(20U)));
  EXPECT_EQ(simulation.addModel("floor", {}, Pose3::Identity()).message, "there is a model \"floor\"");
  EXPECT_TRUE(simulation.addModel("crate", {}, poseFromXyzRpy(1.0, 2.25, 0, 0, 0, 0)).ok());
  EXPECT_FALSE(simulation.kidnap({1.0, 2.25, 0.0}).ok()) << "there stands a crate";
  EXPECT_TRUE(simulation.step(100).ok());
  EXPECT_EQ(simulation.status().stamp_us, kSecondUs);
  EXPECT_THAT(simulation.playScenario("scenario 1\nat 0 remove nothing\n").message,
              HasSubstr("scenario:2: no object"));
  EXPECT_THAT(simulation.playScenario("scenario 1\nat\n").message, HasSubstr("scenario:2: \"at\""));
  EXPECT_TRUE(simulation.playScenario("scenario 1\nat 0.5 kidnap at_m=-4.25,0\n").ok());
  EXPECT_TRUE(simulation.step(60).ok());
  EXPECT_TRUE(eventually([&] {
    const auto truth = simulation.truthSince(-1, 500ms);
    return !truth.samples.empty() && truth.samples.back().kidnaps == 1;
  }));
  EXPECT_TRUE(simulation.reset(9).ok());
  EXPECT_EQ(simulation.status().seed, 9U);
  EXPECT_EQ(simulation.status().stamp_us, 0);
  EXPECT_TRUE(simulation.addModel("crate", {}, poseFromXyzRpy(1.0, 2.25, 0, 0, 0, 0)).ok()) << "it had gone";
}

TEST(SimulatorProcess, NamesWhatIsWrongWithItsConfiguration) {
  ComponentProcess keys("simulator",
                        {kConfig, kWorld, kEndpoint, "--Simulator.Speed=0", "--Simulator.Sed=1"});
  EXPECT_EQ(keys.waitForExit(kPatience), 2);
  EXPECT_THAT(keys.error(), HasSubstr("command line: Simulator.Speed = 0 (must be 0.01..1000)"));
  EXPECT_THAT(keys.error(), HasSubstr("unknown key \"Simulator.Sed\""));
  ComponentProcess start("simulator", {kConfig, kWorld, kEndpoint, "--Simulator.Start.Position_m=0 0"});
  EXPECT_EQ(start.waitForExit(kPatience), 2);
  EXPECT_THAT(start.error(), HasSubstr("the start pose lies inside an obstacle of world \"corridor\""));
}

}  // namespace
}  // namespace vismem
