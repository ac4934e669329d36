// Simulation and replay over a real connection: commands, refusals, lost peers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/robot_ice/replay_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class ControlLoopback : public ::testing::Test {
 protected:
  void SetUp() override { server.activate(); }
  template <typename Prx>
  std::shared_ptr<Prx> proxy(const std::string& identity) {
    return client.proxy<Prx>(identity, server.port());
  }

  LoopbackServer server;
  LoopbackClient client;
};

class FakeSimulation : public SimulationControl {
 public:
  SimulationStatus status() const override { return {"corridor", 5, 1000, paused, speed, 0.9, consumers}; }
  SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds) override {
    if (after_us >= 1000) return {};
    return {SourceState::kRunning, {{1000, 1, {1, 2, 0.5}, true, 3}}, {}};
  }
  PortReply kidnap(const Pose2& pose) override {
    if (pose.x > 10) return PortReply::rejected("inside a wall");
    place = pose;
    return PortReply::accepted();
  }
  PortReply pause() override {
    paused = true;
    return {};
  }
  PortReply resume() override {
    paused = false;
    return {};
  }
  PortReply setSpeed(double value) override {
    speed = value;
    return {};
  }

  PortReply step(int steps) override {
    return paused ? PortReply::adjusted(std::to_string(steps) + " steps") : PortReply::rejected("not paused");
  }
  PortReply setLockStep(int value) override {
    consumers = value;
    return {};
  }
  PortReply reset(std::uint64_t value) override {
    seed = value;
    return {};
  }
  std::vector<ModelStatus> models() override { return {model}; }
  PortReply addModel(const std::string& name, const PropShape& value, const Pose3& pose) override {
    if (name == model.name) return PortReply::rejected("there is a model \"" + name + "\"");
    model = {name, pose, true, false};
    shape = value;
    return {};
  }
  PortReply removeModel(const std::string& name) override {
    model.present = name != model.name;
    return {};
  }
  PortReply placeModel(const std::string&, const Pose3& pose) override {
    model.T_world_model = pose;
    model.present = true;
    return {};
  }
  PortReply walkModel(const std::string&, const Way& value) override {
    way = value;
    model.walking = true;
    return {};
  }
  PortReply standModel(const std::string&) override {
    model.walking = false;
    return {};
  }
  PortReply slip(double left_m, double right_m) override {
    slipped = {left_m, right_m};
    return {};
  }
  PortReply playScenario(const std::string& text) override {
    return text == "scenario 1" ? PortReply::accepted() : PortReply::rejected("scenario:1: what is this?");
  }

  std::atomic<bool> paused = false;
  std::atomic<double> speed = 1.0;
  std::atomic<int> consumers = 0;
  std::uint64_t seed = 5;
  Pose2 place;
  ModelStatus model{"door", Pose3::Identity(), true, false};
  PropShape shape;
  Way way;
  std::pair<double, double> slipped;
};

TEST_F(ControlLoopback, SimulationIsControlledFromAfar) {
  FakeSimulation simulation;
  const auto servant = std::make_shared<SimulationServant>(simulation);
  servant->start();
  server.add("Simulation", servant);
  RemoteSimulation remote(proxy<avm::SimulationPrx>("Simulation"));
  EXPECT_EQ(remote.status().world, "corridor");
  EXPECT_TRUE(remote.kidnap({1, 2, 3}).ok());
  EXPECT_EQ(simulation.place, (Pose2{1, 2, 3}));
  EXPECT_EQ(remote.kidnap({11, 0, 0}).message, "inside a wall");
  EXPECT_THAT(remote.kidnap({kNaN, 0, 0}).message, HasSubstr("must be finite"));
  EXPECT_TRUE(remote.pause().ok());
  EXPECT_TRUE(remote.status().paused);
  EXPECT_TRUE(remote.resume().ok());
  EXPECT_FALSE(remote.status().paused);
  EXPECT_TRUE(remote.setSpeed(4).ok());
  EXPECT_EQ(remote.status().speed, 4);
  EXPECT_EQ(remote.setSpeed(-1).message, "speed = -1 (must be 0.01..1000)");
  const auto truth = remote.truthSince(kBeforeAllStamps, 2s);
  ASSERT_EQ(truth.samples.size(), 1U) << truth.message;
  EXPECT_EQ(truth.samples[0].kidnaps, 3U);
  servant->stop();
}

TEST_F(ControlLoopback, ASimulatedWorldIsChangedFromAfar) {
  FakeSimulation simulation;
  server.add("Simulation", std::make_shared<SimulationServant>(simulation));
  RemoteSimulation remote(proxy<avm::SimulationPrx>("Simulation"));
  EXPECT_EQ(remote.step(3).message, "not paused");
  remote.pause();
  EXPECT_EQ(remote.step(3).message, "3 steps");
  EXPECT_EQ(remote.step(0).message, "steps = 0 (must be 1..1000)");
  EXPECT_TRUE(remote.setLockStep(2).ok());
  EXPECT_EQ(remote.status().lock_step, 2);
  EXPECT_EQ(remote.setLockStep(-1).message, "consumers = -1 (must be 0..64)");
  EXPECT_TRUE(remote.reset(77).ok());
  EXPECT_EQ(simulation.seed, 77U);

  const Pose3 place = poseFromXyzRpy(1, 2, 3, 0.1, 0.2, 0.3);
  const PropShape robot{PropShape::Kind::kRobot, {0.4, 0.5, 1.2}, {0.1, 0.2, 0.3}};
  EXPECT_TRUE(remote.addModel("visitor", robot, place).ok());
  EXPECT_EQ(remote.addModel("visitor", robot, place).message, "there is a model \"visitor\"");
  EXPECT_EQ(simulation.shape.kind, robot.kind);
  EXPECT_EQ(simulation.shape.size_m, robot.size_m);
  EXPECT_EQ(simulation.shape.color, robot.color);
  ASSERT_EQ(remote.models().size(), 1U);
  EXPECT_EQ(remote.models()[0].name, "visitor");
  EXPECT_TRUE(remote.models()[0].T_world_model.isApprox(place, 1e-12));
  Pose3 nowhere = place;
  nowhere.translation().x() = kNaN;
  EXPECT_THAT(remote.placeModel("visitor", nowhere).message, HasSubstr("must be finite"));
  EXPECT_TRUE(remote.walkModel("visitor", {{{0, 0}, {1, 0}}, false, WayEnd::kStand, 0.7}).ok());
  EXPECT_TRUE(remote.models()[0].walking);
  ASSERT_EQ(simulation.way.points.size(), 2U);
  EXPECT_EQ(simulation.way.points[1], Eigen::Vector2d(1, 0));
  EXPECT_EQ(simulation.way.at_end, WayEnd::kStand);
  EXPECT_EQ(simulation.way.speed_mps, 0.7);
  EXPECT_TRUE(remote.standModel("visitor").ok());
  EXPECT_FALSE(remote.models()[0].walking);
  EXPECT_TRUE(remote.removeModel("visitor").ok());
  EXPECT_FALSE(remote.models()[0].present);
  EXPECT_TRUE(remote.slip(0.1, -0.2).ok());
  EXPECT_EQ(simulation.slipped, std::pair(0.1, -0.2));
  EXPECT_EQ(remote.slip(kNaN, 0).message, "leftM = nan (must be -1..1)");
  EXPECT_TRUE(remote.playScenario("scenario 1").ok());
  EXPECT_EQ(remote.playScenario("?").message, "scenario:1: what is this?");
}

class FakeReplay : public ReplayControl {
 public:
  ReplayStatus status() const override { return now; }
  PortReply play() override {
    now.state = ReplayState::kPlaying;
    return {};
  }
  PortReply pause() override {
    now.state = ReplayState::kPaused;
    return {};
  }
  PortReply seek(StampUs stamp_us) override {
    now.stamp_us = std::clamp(stamp_us, now.first_us, now.last_us);
    return now.stamp_us == stamp_us ? PortReply::accepted() : PortReply::adjusted("to the log's end");
  }
  PortReply setRate(double rate) override {
    now.rate = rate;
    return {};
  }
  PortReply setLoop(bool loop) override {
    now.loop = loop;
    return {};
  }
  PortReply step(int images) override {
    now.stamp_us += images * 100'000;
    return {};
  }
  PortReply setPlayLength(StampUs length_us) override {
    play_length_us = length_us;
    return {};
  }
  PortReply setRange(StampUs begin_us, StampUs end_us) override {
    held.begin_us = begin_us;
    held.end_us = end_us;
    return {};
  }
  ReplayContents contents() const override { return held; }

  StampUs play_length_us = 0;
  ReplayContents held{{{"/odom", "nav_msgs/Odometry", 7}}, {"a note"}, 5, 0, 0};
  ReplayStatus now{ReplayState::kPaused, "a.bag", 5 * kSecondUs, 15 * kSecondUs, 5 * kSecondUs, 1.0, false};
};

TEST_F(ControlLoopback, ReplayIsControlledFromAfar) {
  FakeReplay replay;
  server.add("Replay", std::make_shared<ReplayServant>(replay));
  RemoteReplay remote(proxy<avm::ReplayPrx>("Replay"));
  EXPECT_TRUE(remote.play().ok());
  EXPECT_EQ(remote.status().state, ReplayState::kPlaying);
  EXPECT_EQ(remote.seek(99 * kSecondUs).message, "to the log's end");
  EXPECT_TRUE(remote.setRate(2).ok());
  EXPECT_THAT(remote.setRate(kNaN).message, HasSubstr("must be 0.01..1000"));
  EXPECT_TRUE(remote.setLoop(true).ok());
  EXPECT_EQ(remote.status().rate, 2);
  EXPECT_TRUE(remote.status().loop);
  EXPECT_TRUE(remote.setRange(6 * kSecondUs, 7 * kSecondUs).ok());
  EXPECT_THAT(remote.setRange(7, 7).message, HasSubstr("beginUs = 7 (must be less than endUs = 7)"));
  EXPECT_THAT(remote.step(0).message, HasSubstr("must not be 0"));
  const ReplayContents contents = remote.contents();
  EXPECT_EQ(contents.begin_us, 6 * kSecondUs);
  ASSERT_EQ(contents.topics.size(), 1u);
  EXPECT_EQ(contents.topics[0].messages, 7u);
  EXPECT_EQ(contents.notes, std::vector<std::string>{"a note"});
  EXPECT_TRUE(remote.setPlayLength(250'000).ok());
  EXPECT_EQ(replay.play_length_us, 250'000);

  const auto jde = Ice::checkedCast<jderobot::replayControlPrx>(proxy<Ice::ObjectPrx>("Replay"));
  ASSERT_TRUE(jde);
  EXPECT_TRUE(jde->goTo(2500));  // 2.5 s after the log's beginning at 5 s
  EXPECT_EQ(replay.now.stamp_us, 7'500'000);
  EXPECT_EQ(jde->getTime(), 2500);
  EXPECT_FALSE(jde->goTo(-1));
  EXPECT_FALSE(jde->goTo(std::numeric_limits<Ice::Long>::max()));
  EXPECT_TRUE(jde->pause());
  EXPECT_EQ(jde->getStatus(), jderobot::ReplayerStatus::PAUSED);
  EXPECT_TRUE(jde->setStep(3));
  EXPECT_EQ(replay.play_length_us, 3'000);
  EXPECT_FALSE(jde->setStep(-1));
  EXPECT_TRUE(remote.seek(8 * kSecondUs).ok());
  EXPECT_TRUE(remote.step(-2).ok());
  EXPECT_EQ(replay.now.stamp_us, 7'800'000);
  jde->setReplay(false);
  EXPECT_FALSE(replay.now.loop);
}

TEST_F(ControlLoopback, LostControlsSaySo) {
  RemoteReplay replay(client.proxy<avm::ReplayPrx>("Replay", 1));
  EXPECT_EQ(replay.status().state, ReplayState::kWaiting);
  EXPECT_THAT(replay.play().message, HasSubstr("refused"));
  RemoteSimulation simulation(nullptr);
  EXPECT_EQ(simulation.status().world, "");
  EXPECT_THAT(simulation.pause().message, HasSubstr("no simulation is configured"));
  EXPECT_TRUE(simulation.models().empty());
}

}  // namespace
}  // namespace vismem
