// Pan-tilt and base over a real connection: units, refusals, lost peers.
// Tests C3, C4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>

#include "common/geometry/angles.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/pantilt_ice.h"
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
  EXPECT_TRUE(eventually([&] {
    try {
      return std::abs(encoders->getPTEncodersData()->panAngle - 90.F) < 1e-3;
    } catch (const Ice::UnknownException&) {
      return false;  // before the first sample
    }
  }));
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
  // Without a position command the motors report the measured angles.
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
  LoopbackServer frozen;  // never activated: the system accepts the connection, without a server on it
  RemotePanTiltUnit remote(client.proxy<avm::PanTiltPrx>("PanTilt", frozen.port()));
  const auto began = std::chrono::steady_clock::now();
  const PortReply reply = remote.command({});
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s);  // the bound is 1 s; the rest is a busy machine
  EXPECT_EQ(reply.kind, PortReply::Kind::kRejected);
  EXPECT_THAT(reply.message, HasSubstr("no answer within 1000 ms"));
  EXPECT_EQ(remote.samplesSince(0, 10ms).state, SourceState::kWaiting);
}

/// Stopping a client ends its wait, though the peer is silent, and takes back what this client commanded.
TEST_F(RobotLoopback, StoppedClientsDoNotWaitAndLeaveTheRobotStanding) {
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

}  // namespace
}  // namespace vismem
