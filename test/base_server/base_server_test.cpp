// The process base_server over Ice: motors and encoders, its watchdog, its end, its messages.
// Tests C1, C3.
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <thread>

#include "common/drivers/host_clock.h"
#include "common/geometry/angles.h"
#include "common/robot/command_lease.h"
#include "common/robot_ice/base_ice.h"
#include "support/build_paths.h"
#include "support/ice_client.h"
#include "support/p2os_robot.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::string kConfig = "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/files/base_server.cfg";
const std::string kEndpoint = "--BaseServer.Endpoints=tcp -h 127.0.0.1 -p 0";

/// The stream of a base's odometry, watched sample by sample.
class Watcher {
 public:
  explicit Watcher(MobileBase& base) : base_(base) {}

  /// @return the first sample from now on that fulfils the condition; empty when none came in time.
  template <typename Condition>
  std::optional<OdometrySample> until(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      for (const OdometrySample& sample : base_.samplesSince(newest_us_, 200ms).samples) {
        newest_us_ = sample.stamp_us;
        if (condition(sample)) return sample;
      }
    }
    return std::nullopt;
  }

 private:
  MobileBase& base_;
  StampUs newest_us_ = kBeforeAllStamps;
};

class BaseServer : public testing::Test {
 protected:
  std::unique_ptr<ComponentProcess> serve(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{kConfig, kEndpoint};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<ComponentProcess>("base_server", arguments);
  }
  std::unique_ptr<RemoteMobileBase> connect(const ComponentProcess& server) {
    return std::make_unique<RemoteMobileBase>(ice.find<avm::BasePrx>(server, "Motors"),
                                              ice.find<avm::OdometryPrx>(server, "Encoders"));
  }

  IceClient ice;
};

TEST_F(BaseServer, DrivesWithStampsOfTheHost) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  const auto base = connect(*server);
  ASSERT_EQ(base->start().kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(base->limits().watchdog_s, 0.25);
  EXPECT_EQ(base->setVelocity(0.2, 0.0).kind, PortReply::Kind::kAccepted);
  const PortReply fast = base->setVelocity(7.0, 0.0);
  EXPECT_EQ(fast.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(fast.message, HasSubstr("speed 7 m/s to 0.6 (the limit)"));
  Watcher watcher(*base);
  const auto moved = watcher.until([&](const OdometrySample& s) {
    base->setVelocity(0.2, 0.0);
    return s.T_odom_robot.x > 0.1;
  });
  ASSERT_TRUE(moved);
  EXPECT_NEAR(toSeconds(moved->stamp_us - hostClock_us()), 0.0, 1.0);

  const auto status = ice.find<avm::ComponentPrx>(*server, "base_server/component")->getStatus();
  EXPECT_EQ(status.state, avm::ComponentState::Running);
  ASSERT_EQ(status.rates.size(), 1U);
  EXPECT_EQ(status.rates[0].name, "samples");
  EXPECT_GT(status.rates[0].total, 10);
}

TEST_F(BaseServer, ServesMotorsAndEncodersApart) {
  const auto motors = serve({"--BaseServer.Serves=motors"});
  const auto encoders = serve({"--BaseServer.Serves=encoders"});
  ASSERT_TRUE(motors->waitUntilReady());
  ASSERT_TRUE(encoders->waitUntilReady());
  EXPECT_NO_THROW(ice.find<avm::BasePrx>(*motors, "Motors")->getLimits());
  EXPECT_THROW(ice.find<avm::OdometryPrx>(*motors, "Encoders")->ice_ping(), Ice::ObjectNotExistException);
  EXPECT_THROW(ice.find<avm::BasePrx>(*encoders, "Motors")->ice_ping(), Ice::ObjectNotExistException);
  RemoteMobileBase base(nullptr, ice.find<avm::OdometryPrx>(*encoders, "Encoders"));
  EXPECT_TRUE(Watcher(base).until([](const OdometrySample&) { return true; }));
}

/// At full speed and turning, its commander vanishes: killed, or frozen with its connection open.
class BaseServerWatchdog : public BaseServer, public testing::WithParamInterface<int> {};

TEST_P(BaseServerWatchdog, StandsWithin500msOfItsCommandersEnd) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  ChildProcess commander(
      {VISMEM_BIN_DIR "/base_commander", server->proxy("Motors"), "0.6", std::to_string(degToRad(100.0))});
  const auto base = connect(*server);
  Watcher watcher(*base);
  ASSERT_TRUE(watcher.until([](const OdometrySample& s) { return s.v_mps > 0.599 && s.w_radps > 1.74; }))
      << commander.error();
  const StampUs vanished_us = hostClock_us();
  ASSERT_TRUE(commander.signal(GetParam()));
  const auto standing = watcher.until([&](const OdometrySample& s) {
    return s.stamp_us > vanished_us && s.v_mps == 0.0 && s.w_radps == 0.0;
  });
  ASSERT_TRUE(standing);
  const double took_s = toSeconds(standing->stamp_us - vanished_us);
  RecordProperty("stopped_after_ms", static_cast<int>(took_s * 1000));
  EXPECT_LT(took_s, 0.5);
  // It stays so until the next command; another client's is accepted once the lease of the first has ended.
  const auto ended = std::chrono::steady_clock::now() + 2 * CommandLease::kImplicitTimeout;
  PortReply reply = base->setVelocity(0.1, 0.0);
  while (!reply.ok() && std::chrono::steady_clock::now() < ended) {
    std::this_thread::sleep_for(20ms);
    reply = base->setVelocity(0.1, 0.0);
  }
  EXPECT_EQ(reply.kind, PortReply::Kind::kAccepted) << reply.message;
  EXPECT_TRUE(watcher.until([](const OdometrySample& s) { return s.v_mps > 0.0; }));
}

INSTANTIATE_TEST_SUITE_P(Ends, BaseServerWatchdog, testing::Values(SIGKILL, SIGSTOP),
                         [](const auto& end) { return end.param == SIGKILL ? "Killed" : "Frozen"; });

TEST_F(BaseServer, StandsBeforeItEndsOnSigterm) {
  const auto server = serve();
  ASSERT_TRUE(server->waitUntilReady());
  ChildProcess commander({VISMEM_BIN_DIR "/base_commander", server->proxy("Motors"), "0.6", "0"});
  const auto base = connect(*server);
  ASSERT_TRUE(Watcher(*base).until([](const OdometrySample& s) { return s.v_mps > 0.5; }));
  const auto began = std::chrono::steady_clock::now();
  ASSERT_TRUE(server->signal(SIGTERM));
  EXPECT_EQ(server->waitForExit(kPatience), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 3s);  // 0.15 s of braking, and a busy machine
  EXPECT_THAT(server->error(), HasSubstr("the base stands at x "));
}

/// A robot on a serial line that is not there at first, is commanded by a client that vanishes, and
/// unplugged.
TEST_F(BaseServer, ServesAPioneerThatComesAndGoes) {
  P2osRobot robot;
  robot.unplug();
  ComponentProcess server("base_server",
                          {kEndpoint, "--BaseServer.Driver=pioneer", "--BaseServer.Port=" + robot.path(),
                           "--BaseServer.Acceleration_mps2=3"});
  ASSERT_TRUE(server.waitUntilReady());
  const auto status = ice.find<avm::ComponentPrx>(server, "base_server/component");
  EXPECT_TRUE(eventually([&] { return status->getStatus().state == avm::ComponentState::Degraded; }));
  EXPECT_EQ(status->getStatus().reason, "base: " + robot.path() + ": no such device");
  robot.plugIn();
  ASSERT_TRUE(eventually([&] { return status->getStatus().state == avm::ComponentState::Running; }))
      << status->getStatus().reason;
  const auto base = connect(server);
  ChildProcess commander({VISMEM_BIN_DIR "/base_commander", server.proxy("Motors"), "0.3", "0"});
  ASSERT_TRUE(eventually([&] { return robot.speed_mmps() > 299.0; })) << commander.error();
  ASSERT_TRUE(commander.signal(SIGKILL));
  EXPECT_TRUE(eventually([&] { return robot.speed_mmps() == 0.0; }));
  EXPECT_FALSE(robot.watchdogCame()) << "the server's watchdog is the quicker one";
  robot.unplug();
  EXPECT_TRUE(eventually([&] { return status->getStatus().state == avm::ComponentState::Degraded; }));
  robot.plugIn();
  EXPECT_TRUE(eventually([&] { return base->setVelocity(0.3, 0.0).ok() && robot.speed_mmps() > 299.0; }));
  ASSERT_TRUE(server.signal(SIGTERM));
  EXPECT_EQ(server.waitForExit(kPatience), 0);
  EXPECT_EQ(robot.speed_mmps(), 0.0);
  EXPECT_THAT(server.error(), HasSubstr("the base stands at x "));
}

/// The server is frozen while the robot drives, for longer than the robot's own watchdog waits. When it goes
/// on, none of its packets may wake the old speed up.
TEST_F(BaseServer, DoesNotReviveASpeedAfterItWasFrozen) {
  P2osRobot::Traits traits;
  traits.watchdog_s = 0.6;
  P2osRobot robot(traits);
  ComponentProcess server("base_server",
                          {kEndpoint, "--BaseServer.Driver=pioneer", "--BaseServer.Port=" + robot.path(),
                           "--BaseServer.Acceleration_mps2=3"});
  ASSERT_TRUE(server.waitUntilReady());
  const auto base = connect(server);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  const auto waitFor = [&](const std::function<bool()>& condition) {
    while (!condition() && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(5ms);
    return condition();
  };
  // On a busy machine the freeze may come too late, when the server has stopped the robot: then once more.
  do {
    ASSERT_TRUE(server.signal(SIGCONT));
    ASSERT_TRUE(waitFor([&] { return base->setVelocity(0.3, 0.0).ok() && robot.speed_mmps() > 299.0; }));
    ASSERT_TRUE(server.signal(SIGSTOP));
    ASSERT_TRUE(waitFor([&] { return robot.watchdogCame() && robot.speed_mmps() == 0.0; }));
  } while (robot.setSpeed_mmps() == 0.0);
  robot.fastest_mmps();
  ASSERT_TRUE(server.signal(SIGCONT));
  EXPECT_TRUE(waitFor([&] { return !robot.watchdogCame() && robot.setSpeed_mmps() == 0.0; }));
  EXPECT_EQ(robot.fastest_mmps(), 0.0);
}

TEST_F(BaseServer, NamesWhatIsWrongWithItsConfiguration) {
  const auto values = serve({"--BaseServer.Watchdog_s=0", "--BaseServer.Serves=wheels", "--BaseServer.Rate=1",
                             "--BaseServer.Odometry.Preset=perfect"});
  EXPECT_EQ(values->waitForExit(kPatience), 2);
  EXPECT_THAT(values->error(), HasSubstr("BaseServer.Watchdog_s = 0 (must be 0.05..60)"));
  EXPECT_THAT(values->error(),
              HasSubstr("BaseServer.Serves = wheels (must be one of: both, motors, encoders)"));
  EXPECT_THAT(values->error(),
              HasSubstr("unknown key \"BaseServer.Rate\" (did you mean \"BaseServer.Rate_hz\"?)"));
  EXPECT_THAT(values->error(), HasSubstr("BaseServer.Odometry.Preset = perfect (must be one of: none, "));
  const auto driver = serve({"--BaseServer.Driver=simulatd"});
  EXPECT_EQ(driver->waitForExit(kPatience), 2);
  EXPECT_THAT(driver->error(), HasSubstr("BaseServer.Driver = simulatd (unknown driver (did you mean "
                                         "\"simulated\"?); must be one of: pioneer, simulated)"));
}

}  // namespace
}  // namespace vismem
