// Pan-tilt, base, simulation and replay over a real connection: units, refusals, lost peers (SPEC C3, C4).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>

#include "common/geometry/angles.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/replay_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Obeys at once and gives a new sample whenever asked.
class ObedientPanTilt : public PanTiltUnit {
 public:
  PanTiltLimits limits() const override {
    return {degToRad(-159), degToRad(159), degToRad(-31), degToRad(31), degToRad(120), degToRad(90)};
  }
  PortReply start() override { return PortReply::accepted(); }
  PortReply command(const PanTiltCommand& command) override {
    const std::lock_guard lock(mutex);
    last = command;
    if (stuck) return PortReply::rejected("the unit is stuck");
    if (std::abs(command.pan_rad) > degToRad(159)) return PortReply::adjusted("pan to 159 deg");
    return PortReply::accepted();
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    const std::lock_guard lock(mutex);
    const StampUs stamp_us = after_us < 0 ? 1000 : after_us + 1000;
    return {SourceState::kRunning, {{stamp_us, 7, last.pan_rad, last.tilt_rad}}, {}};
  }
  void stop() override {}

  std::mutex mutex;
  PanTiltCommand last;
  bool stuck = false;
};

class RecordingBase : public MobileBase {
 public:
  BaseLimits limits() const override { return {0.5, 1.0, 0.6}; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply setVelocity(double v_mps, double w_radps) override {
    v = v_mps;
    w = w_radps;
    if (std::abs(v_mps) > 0.5) return PortReply::adjusted("speed to 0.5 m/s");
    return PortReply::accepted();
  }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    if (after_us >= 1000) return {};
    return {SourceState::kRunning, {{1000, 1, {1.5, -0.5, degToRad(-90)}, 0.1, 0.2}}, {}};
  }
  void stop() override {}

  std::atomic<double> v = 0;
  std::atomic<double> w = 0;
};

class RobotLoopback : public ::testing::Test {
 protected:
  ~RobotLoopback() override {
    pan_tilt->stop();
    odometry->stop();
  }
  void SetUp() override {
    server.add("PanTilt", pan_tilt);
    server.add("Motors", std::make_shared<BaseServant>(base, [this] { return now.load(); }));
    server.add("Encoders", odometry);
    server.activate();
    pan_tilt->start();
    odometry->start();
  }
  template <typename Prx>
  std::shared_ptr<Prx> proxy(const std::string& identity) {
    return client.proxy<Prx>(identity, server.port());
  }

  ObedientPanTilt unit;
  RecordingBase base;
  std::atomic<std::chrono::steady_clock::time_point> now{std::chrono::steady_clock::time_point(1h)};
  std::shared_ptr<PanTiltServant> pan_tilt =
      std::make_shared<PanTiltServant>(unit, Eigen::Vector3d(0.05, 0.0, 0.45));
  std::shared_ptr<OdometryServant> odometry = std::make_shared<OdometryServant>(base);
  LoopbackServer server;
  LoopbackClient client;
};

TEST_F(RobotLoopback, PanTiltCommandsArriveAsGiven) {
  RemotePanTiltUnit remote(proxy<avm::PanTiltPrx>("PanTilt"));
  EXPECT_EQ(remote.start().kind, PortReply::Kind::kAccepted);
  EXPECT_DOUBLE_EQ(remote.limits().max_pan_rad, degToRad(159));
  EXPECT_EQ(remote.command({PanTiltCommand::Kind::kPosition, 0.5, -0.2, 0.7, 0.8}).kind,
            PortReply::Kind::kAccepted);
  EXPECT_EQ(unit.last.kind, PanTiltCommand::Kind::kPosition);
  EXPECT_EQ(unit.last.pan_rad, 0.5);
  EXPECT_EQ(unit.last.tilt_rad, -0.2);
  EXPECT_EQ(unit.last.pan_rate_radps, 0.7);
  EXPECT_EQ(unit.last.tilt_rate_radps, 0.8);
  EXPECT_TRUE(eventually([&] { return proxy<avm::PanTiltPrx>("PanTilt")->getPanTiltStatus().done; }));
  EXPECT_EQ(remote.command({PanTiltCommand::Kind::kVelocity, 0, 0, -0.7, 0.8}).kind,
            PortReply::Kind::kAccepted);
  EXPECT_EQ(unit.last.kind, PanTiltCommand::Kind::kVelocity);
  EXPECT_EQ(unit.last.pan_rate_radps, -0.7);
  const auto status = proxy<avm::PanTiltPrx>("PanTilt")->getPanTiltStatus();
  EXPECT_FALSE(status.done);
  EXPECT_EQ(status.goal.panRad, 0.5);
}

TEST_F(RobotLoopback, PanTiltAdjustsAndRefusesWithReasons) {
  RemotePanTiltUnit remote(proxy<avm::PanTiltPrx>("PanTilt"));
  const PortReply adjusted = remote.command({PanTiltCommand::Kind::kPosition, 3.0, 0, 0, 0});
  EXPECT_EQ(adjusted.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(adjusted.message, "pan to 159 deg");
  const PortReply absurd = remote.command({PanTiltCommand::Kind::kPosition, kNaN, 0, 0, 0});
  EXPECT_EQ(absurd.kind, PortReply::Kind::kRejected);
  EXPECT_THAT(absurd.message, HasSubstr("panRad = nan (must be finite)"));
  EXPECT_THAT(remote.command({PanTiltCommand::Kind::kPosition, 0, 0, -1, 0}).message,
              HasSubstr("must be >= 0"));
  unit.stuck = true;
  EXPECT_EQ(remote.command({PanTiltCommand::Kind::kPosition, 0, 0, 0, 0}).message, "the unit is stuck");
}

TEST_F(RobotLoopback, PanTiltSpeaksDegreesToJdeRobot) {
  const auto motors = Ice::checkedCast<jderobot::PTMotorsPrx>(proxy<Ice::ObjectPrx>("PanTilt"));
  const auto encoders = Ice::checkedCast<jderobot::PTEncodersPrx>(proxy<Ice::ObjectPrx>("PanTilt"));
  ASSERT_TRUE(motors && encoders);
  const auto data = std::make_shared<jderobot::PTMotorsData>(90.F, 10.F, -20.F, 5.F, 0);
  EXPECT_EQ(motors->setPTMotorsData(data), 0);
  {
    const std::lock_guard lock(unit.mutex);
    EXPECT_NEAR(unit.last.pan_rad, degToRad(90), 1e-6);
    EXPECT_NEAR(unit.last.tilt_rad, degToRad(-20), 1e-6);
    EXPECT_NEAR(unit.last.pan_rate_radps, degToRad(10), 1e-6);
    EXPECT_NEAR(unit.last.tilt_rate_radps, degToRad(5), 1e-6);
  }
  EXPECT_FLOAT_EQ(motors->getPTMotorsParams()->minTilt, -31.F);
  EXPECT_FLOAT_EQ(motors->getPTMotorsParams()->maxPanSpeed, 120.F);
  EXPECT_TRUE(eventually([&] { return std::abs(encoders->getPTEncodersData()->panAngle - 90.F) < 1e-3; }));
  EXPECT_NEAR(encoders->getPTEncodersData()->tiltAngle, -20.F, 1e-3);
  EXPECT_EQ(encoders->getPTEncodersData()->clock, 7);
  data->tilt = std::numeric_limits<float>::infinity();
  EXPECT_EQ(motors->setPTMotorsData(data), -1);
  EXPECT_EQ(motors->setPTMotorsData(nullptr), -1);
}

TEST_F(RobotLoopback, PanTiltIsJdeRobotsPoseIn3DToo) {
  const auto motors = Ice::checkedCast<jderobot::Pose3DMotorsPrx>(proxy<Ice::ObjectPrx>("PanTilt"));
  const auto encoders = Ice::checkedCast<jderobot::Pose3DEncodersPrx>(proxy<Ice::ObjectPrx>("PanTilt"));
  ASSERT_TRUE(motors && encoders);
  // Without a position command the motors tell what is measured.
  EXPECT_TRUE(eventually([&] {
    try {
      return motors->getPose3DMotorsData()->pan == 0.F;
    } catch (const Ice::UnknownException&) {
      return false;  // no sample yet
    }
  }));
  // A client changes what it has read and sends it back.
  const auto data = motors->getPose3DMotorsData();
  EXPECT_FLOAT_EQ(data->x, 0.05F);
  EXPECT_FLOAT_EQ(data->z, 0.45F);
  EXPECT_EQ(data->roll, 0.F);
  data->pan = 30.F;
  data->tilt = -10.F;
  data->panSpeed = 20.F;
  EXPECT_EQ(motors->setPose3DMotorsData(data), 0);
  {
    const std::lock_guard lock(unit.mutex);
    EXPECT_NEAR(unit.last.pan_rad, degToRad(30), 1e-6);
    EXPECT_NEAR(unit.last.tilt_rad, degToRad(-10), 1e-6);
    EXPECT_NEAR(unit.last.pan_rate_radps, degToRad(20), 1e-6);
    EXPECT_EQ(unit.last.tilt_rate_radps, 0.0);
  }
  EXPECT_NEAR(motors->getPose3DMotorsData()->pan, 30.F, 1e-4);
  EXPECT_NEAR(motors->getPose3DMotorsData()->panSpeed, 20.F, 1e-4);
  EXPECT_TRUE(eventually([&] { return std::abs(encoders->getPose3DEncodersData()->pan - 30.F) < 1e-3; }));
  const auto measured = encoders->getPose3DEncodersData();
  EXPECT_NEAR(measured->tilt, -10.F, 1e-3);
  EXPECT_FLOAT_EQ(measured->x, 0.05F);
  EXPECT_FLOAT_EQ(measured->maxPan, 159.F);
  EXPECT_FLOAT_EQ(measured->minPan, -159.F);
  EXPECT_FLOAT_EQ(measured->maxTilt, 31.F);
  EXPECT_FLOAT_EQ(measured->minTilt, -31.F);
  EXPECT_EQ(measured->clock, 7);
  EXPECT_FLOAT_EQ(motors->getPose3DMotorsParams()->minTilt, -31.F);
  EXPECT_FLOAT_EQ(motors->getPose3DMotorsParams()->maxTiltSpeed, 90.F);
  // Out of reach: taken to the limit, and the motors say so.
  data->pan = 170.F;
  EXPECT_EQ(motors->setPose3DMotorsData(data), 0);
  EXPECT_NEAR(motors->getPose3DMotorsData()->pan, 159.F, 1e-4);
  data->x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(motors->setPose3DMotorsData(data), -1);
  EXPECT_EQ(motors->setPose3DMotorsData(nullptr), -1);
}

TEST_F(RobotLoopback, SamplesFollowEachOther) {
  RemotePanTiltUnit remote(proxy<avm::PanTiltPrx>("PanTilt"));
  StampUs newest_us = kBeforeAllStamps;
  for (int i = 0; i < 5; ++i) {
    const auto batch = remote.samplesSince(newest_us, 2s);
    ASSERT_FALSE(batch.samples.empty()) << batch.message;
    for (const auto& sample : batch.samples) {
      EXPECT_GT(sample.stamp_us, newest_us);
      newest_us = sample.stamp_us;
    }
  }
}

TEST_F(RobotLoopback, BaseTakesSpeedsAndServesJdeRobotsEncoders) {
  RemoteMobileBase remote(proxy<avm::BasePrx>("Motors"), proxy<avm::OdometryPrx>("Encoders"));
  EXPECT_EQ(remote.start().kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(remote.limits().watchdog_s, 0.6);
  EXPECT_EQ(remote.setVelocity(0.3, -0.4).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(base.v, 0.3);
  EXPECT_EQ(base.w, -0.4);
  EXPECT_EQ(remote.setVelocity(2.0, 0).message, "speed to 0.5 m/s");
  EXPECT_THAT(remote.setVelocity(kNaN, 0).message, HasSubstr("vMps = nan"));
  const auto batch = remote.samplesSince(kBeforeAllStamps, 2s);
  ASSERT_EQ(batch.samples.size(), 1U) << batch.message;
  EXPECT_EQ(batch.samples[0].T_odom_robot.x, 1.5);
  const auto encoders = Ice::checkedCast<jderobot::EncodersPrx>(proxy<Ice::ObjectPrx>("Encoders"));
  EXPECT_FLOAT_EQ(encoders->getEncodersData()->robotx, 1500.F);
  EXPECT_FLOAT_EQ(encoders->getEncodersData()->robottheta, 270.F);
  // The same pose in metres, with a quaternion of -45 degrees; dead reckoning cannot be set.
  const auto pose = Ice::checkedCast<jderobot::Pose3DPrx>(proxy<Ice::ObjectPrx>("Encoders"));
  ASSERT_TRUE(pose);
  EXPECT_FLOAT_EQ(pose->getPose3DData()->x, 1.5F);
  EXPECT_FLOAT_EQ(pose->getPose3DData()->y, -0.5F);
  EXPECT_NEAR(pose->getPose3DData()->q0, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(pose->getPose3DData()->q3, -std::sqrt(0.5), 1e-6);
  EXPECT_EQ(pose->setPose3DData(pose->getPose3DData()), -1);
}

TEST_F(RobotLoopback, JdeRobotsMotorsKeepTheOtherSpeedUntilTheWatchdog) {
  const auto motors = Ice::checkedCast<jderobot::MotorsPrx>(proxy<Ice::ObjectPrx>("Motors"));
  ASSERT_TRUE(motors);
  EXPECT_EQ(motors->setW(0.5F), 0);
  EXPECT_EQ(motors->setV(0.2F), 0);
  EXPECT_NEAR(base.v, 0.2, 1e-6);
  EXPECT_NEAR(base.w, 0.5, 1e-6);
  EXPECT_FLOAT_EQ(motors->getV(), 0.2F);
  EXPECT_EQ(motors->setV(3.F), 0);
  EXPECT_FLOAT_EQ(motors->getV(), 0.5F);
  // The base has stopped itself; a new speed must not bring the old turn back.
  now = now.load() + 700ms;
  EXPECT_FLOAT_EQ(motors->getW(), 0.F);
  EXPECT_EQ(motors->setV(0.1F), 0);
  EXPECT_EQ(base.w, 0.0);
  EXPECT_EQ(motors->setV(std::numeric_limits<float>::quiet_NaN()), -1);
  EXPECT_EQ(motors->setL(0.1F), -1);
  EXPECT_EQ(motors->setL(0.F), 0);
}

TEST_F(RobotLoopback, AbsentPeersAreReasonsNotExceptions) {
  const auto wrong = client.proxy<avm::PanTiltPrx>("PanTilt", 1);
  RemotePanTiltUnit remote(wrong);
  EXPECT_THAT(remote.command({}).message, HasSubstr("refused"));
  EXPECT_EQ(remote.samplesSince(0, 300ms).state, SourceState::kWaiting);
  EXPECT_EQ(remote.limits().max_pan_rad, 0.0);
  RemoteMobileBase read_only(nullptr, proxy<avm::OdometryPrx>("Encoders"));
  EXPECT_EQ(read_only.start().kind, PortReply::Kind::kAccepted);
  EXPECT_THAT(read_only.setVelocity(0, 0).message, HasSubstr("no base with motors"));
  EXPECT_FALSE(read_only.samplesSince(kBeforeAllStamps, 2s).samples.empty());
}

/// A peer that takes connections but never answers costs a control loop at most the command's bound.
TEST_F(RobotLoopback, FrozenPeersAreCutOff) {
  LoopbackServer frozen;  // never activated: the system accepts the connection, nobody speaks on it
  RemotePanTiltUnit remote(client.proxy<avm::PanTiltPrx>("PanTilt", frozen.port()));
  const auto began = std::chrono::steady_clock::now();
  const PortReply reply = remote.command({});
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s);  // the bound is 1 s; the rest is a busy machine
  EXPECT_EQ(reply.kind, PortReply::Kind::kRejected);
  EXPECT_THAT(reply.message, HasSubstr("no answer within 1000 ms"));
  EXPECT_EQ(remote.samplesSince(0, 10ms).state, SourceState::kWaiting);
}

/// Stopping a client ends its wait, though the peer is silent, and takes back what this client commanded.
TEST_F(RobotLoopback, StoppedClientsWaitForNobodyAndLeaveTheRobotStanding) {
  LoopbackServer frozen;  // never activated
  RemoteMobileBase silent(nullptr, client.proxy<avm::OdometryPrx>("Encoders", frozen.port()));
  std::atomic<bool> waits = false;
  std::thread reader([&] {
    waits = true;
    silent.samplesSince(kBeforeAllStamps, 60s);
  });
  while (!waits) std::this_thread::yield();
  silent.stop();
  reader.join();  // far sooner than 60 s, or the test times out

  RemoteMobileBase driver(proxy<avm::BasePrx>("Motors"), proxy<avm::OdometryPrx>("Encoders"));
  RemoteMobileBase onlooker(proxy<avm::BasePrx>("Motors"), proxy<avm::OdometryPrx>("Encoders"));
  ASSERT_TRUE(driver.setVelocity(0.3, 0.0).ok());
  onlooker.stop();
  EXPECT_EQ(base.v, 0.3);
  driver.stop();
  EXPECT_EQ(base.v, 0.0);
  RemotePanTiltUnit remote(proxy<avm::PanTiltPrx>("PanTilt"));
  ASSERT_TRUE(remote.command({PanTiltCommand::Kind::kVelocity, 0, 0, 0.4, 0.0}).ok());
  remote.stop();
  const std::lock_guard lock(unit.mutex);
  EXPECT_EQ(unit.last.kind, PanTiltCommand::Kind::kVelocity);
  EXPECT_EQ(unit.last.pan_rate_radps, 0.0);
}

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

TEST_F(RobotLoopback, SimulationIsControlledFromAfar) {
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

TEST_F(RobotLoopback, ASimulatedWorldIsChangedFromAfar) {
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
  EXPECT_TRUE(remote.addModel("guest", robot, place).ok());
  EXPECT_EQ(remote.addModel("guest", robot, place).message, "there is a model \"guest\"");
  EXPECT_EQ(simulation.shape.kind, robot.kind);
  EXPECT_EQ(simulation.shape.size_m, robot.size_m);
  EXPECT_EQ(simulation.shape.color, robot.color);
  ASSERT_EQ(remote.models().size(), 1U);
  EXPECT_EQ(remote.models()[0].name, "guest");
  EXPECT_TRUE(remote.models()[0].T_world_model.isApprox(place, 1e-12));
  Pose3 nowhere = place;
  nowhere.translation().x() = kNaN;
  EXPECT_THAT(remote.placeModel("guest", nowhere).message, HasSubstr("must be finite"));
  EXPECT_TRUE(remote.walkModel("guest", {{{0, 0}, {1, 0}}, false, WayEnd::kStand, 0.7}).ok());
  EXPECT_TRUE(remote.models()[0].walking);
  ASSERT_EQ(simulation.way.points.size(), 2U);
  EXPECT_EQ(simulation.way.points[1], Eigen::Vector2d(1, 0));
  EXPECT_EQ(simulation.way.at_end, WayEnd::kStand);
  EXPECT_EQ(simulation.way.speed_mps, 0.7);
  EXPECT_TRUE(remote.standModel("guest").ok());
  EXPECT_FALSE(remote.models()[0].walking);
  EXPECT_TRUE(remote.removeModel("guest").ok());
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

  ReplayStatus now{ReplayState::kPaused, "a.bag", 5 * kSecondUs, 15 * kSecondUs, 5 * kSecondUs, 1.0, false};
};

TEST_F(RobotLoopback, ReplayIsControlledFromAfar) {
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

  const auto jde = Ice::checkedCast<jderobot::replayControlPrx>(proxy<Ice::ObjectPrx>("Replay"));
  ASSERT_TRUE(jde);
  EXPECT_TRUE(jde->goTo(2500));  // 2.5 s after the log's beginning at 5 s
  EXPECT_EQ(replay.now.stamp_us, 7'500'000);
  EXPECT_EQ(jde->getTime(), 2500);
  EXPECT_FALSE(jde->goTo(-1));
  EXPECT_FALSE(jde->goTo(std::numeric_limits<Ice::Long>::max()));
  EXPECT_TRUE(jde->pause());
  EXPECT_EQ(jde->getStatus(), jderobot::ReplayerStatus::PAUSED);
  EXPECT_FALSE(jde->setStep(3));
  jde->setReplay(false);
  EXPECT_FALSE(replay.now.loop);
}

TEST_F(RobotLoopback, LostControlsSaySo) {
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
