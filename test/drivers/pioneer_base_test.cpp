// The Pioneer's driver with a robot on a pseudo terminal: its session, the safety rules against resuming an
// old speed, and the message of each failure.
#include "drivers/pioneer_p2os/pioneer_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "common/robot/samples.h"
#include "support/eventually.h"
#include "support/p2os_robot.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using p2os::Command;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using Faults = P2osRobot::Faults;

constexpr StampUs kEverything = std::numeric_limits<StampUs>::min();

class PioneerTest : public testing::Test {
 protected:
  /// Its watchdog comes sooner than a real one's, so that tests need not wait for it.
  static P2osRobot::Traits impatient() {
    P2osRobot::Traits traits;
    traits.watchdog_s = 0.8;
    return traits;
  }
  void use(const P2osRobot::Traits& traits) { robot = std::make_unique<P2osRobot>(traits); }
  PioneerBase& base(const std::function<void(PioneerBase::Params&)>& change = [](auto&) {}) {
    if (!base_) {
      PioneerBase::Params params;
      params.port = robot->path();
      params.bauds_bps = {9600};
      params.acceleration_mps2 = 3.0;
      params.silent_after = 400ms;
      params.lost_after = 800ms;
      change(params);
      base_ = std::make_unique<PioneerBase>(params);
    }
    return *base_;
  }
  void end() { base_.reset(); }
  /// Commands until the robot drives at least this fast.
  testing::AssertionResult drive(double v_mps) {
    if (eventually([&] {
          base().setVelocity(v_mps, 0.0);
          return robot->speed_mmps() > 999.0 * v_mps;
        })) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << "it does not drive";
  }
  std::string waitingFor() { return base().samplesSince(std::numeric_limits<StampUs>::max(), 0ms).message; }
  std::string condition() { return base().samplesSince(kEverything, 100ms).message; }
  bool standing() const { return robot->speed_mmps() == 0.0 && robot->turnRate_degps() == 0.0; }
  /// Follows the robot for a while.
  /// @return the highest speed [mm/s].
  double fastestDuring(std::chrono::milliseconds time) {
    robot->fastest_mmps();
    std::this_thread::sleep_for(time);
    return robot->fastest_mmps();
  }

  std::unique_ptr<P2osRobot> robot = std::make_unique<P2osRobot>(impatient());

 private:
  std::unique_ptr<PioneerBase> base_;
};

TEST_F(PioneerTest, OpensASessionAndSetsTheRobotUp) {
  ASSERT_EQ(base().start().kind, PortReply::Kind::kAccepted);
  EXPECT_TRUE(robot->sessionOpen());
  EXPECT_TRUE(robot->motorsOn());
  ASSERT_TRUE(drive(0.3));
  EXPECT_EQ(robot->setSpeed_mmps(), 300.0);
  const auto samples = base().samplesSince(kEverything, 1s);
  EXPECT_EQ(samples.message, "");
  base().stop();
  EXPECT_TRUE(standing());
  EXPECT_TRUE(eventually([&] { return !robot->sessionOpen() && !robot->motorsOn(); }));
}

TEST_F(PioneerTest, FindsTheRateAtWhichTheRobotSpeaks) {
  P2osRobot::Traits traits;
  traits.baud_bps = 38400;
  use(traits);
  auto& pioneer = base([](PioneerBase::Params& p) { p.bauds_bps = {9600, 38400}; });
  EXPECT_EQ(pioneer.start().kind, PortReply::Kind::kAccepted);
}

TEST_F(PioneerTest, ClosesAnOldSessionWithoutRevivingItsSpeed) {
  robot->leaveOldSession(400.0);
  ASSERT_EQ(base().start().kind, PortReply::Kind::kAccepted);
  EXPECT_TRUE(robot->sessionOpen());
  EXPECT_EQ(fastestDuring(300ms), 0.0);
  EXPECT_EQ(robot->setSpeed_mmps(), 0.0);
}

TEST_F(PioneerTest, SaysWhenAnOldSessionDoesNotEnd) {
  robot->change([](Faults& f) { f.stubborn_session = true; });
  robot->leaveOldSession(400.0);
  const PortReply reply = base().start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, robot->path() + ": the robot goes on with an old session and does not close it");
  EXPECT_EQ(robot->fastest_mmps(), 0.0);
}

/// The process is stopped for longer than the robot's watchdog, with a speed set: nothing that it sends
/// afterwards may make the robot go on. Here the robot's watchdog comes while the driver's own has the last
/// word.
TEST_F(PioneerTest, SaysStandBeforeAnythingElseWhenItsClientIsGone) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.4));
  const auto last = Clock::now();
  ASSERT_TRUE(eventually([&] { return robot->setSpeed_mmps() == 0.0; }));
  EXPECT_LT(Clock::now() - last, 1s);
  ASSERT_TRUE(eventually([&] { return standing(); }));
  // The first packets after the last speed: stop and speeds of 0, and only then pulses.
  const auto heard = robot->heard();
  auto at = heard.end();
  for (auto packet = heard.begin(); packet != heard.end(); ++packet) {
    const bool moves = packet->data.front() == static_cast<int>(Command::kSpeed) && packet->data[2] != 0;
    if (moves) at = packet;
  }
  ASSERT_NE(at, heard.end());
  ASSERT_GE(heard.end() - at, 3);
  EXPECT_EQ((at + 1)->data.front(), static_cast<int>(Command::kTurnRate));
  EXPECT_EQ((at + 2)->data.front(), static_cast<int>(Command::kStop));
  // Kept content from then on, over the time of its watchdog, and never moving.
  EXPECT_EQ(fastestDuring(1000ms), 0.0);
  EXPECT_FALSE(robot->watchdogCame());
}

TEST_F(PioneerTest, DoesNotReviveASpeedWhenTheLineReturns) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.4));
  robot->unplug();
  // The robot drives on by itself until its watchdog comes: that is why it has one.
  ASSERT_TRUE(eventually([&] { return standing(); }));
  EXPECT_TRUE(robot->watchdogCame());
  EXPECT_EQ(robot->setSpeed_mmps(), 400.0) << "and would go on with the next packet";
  EXPECT_EQ(waitingFor(), robot->path() + ": no such device");
  const PortReply refused = base().setVelocity(0.2, 0.0);
  EXPECT_EQ(refused.kind, PortReply::Kind::kRejected);
  EXPECT_EQ(refused.message, robot->path() + ": no such device");
  const Pose2 before = base().samplesSince(kEverything, 0ms).samples.back().T_odom_robot;
  robot->fastest_mmps();
  robot->plugIn();
  ASSERT_TRUE(eventually([&] { return base().setVelocity(0.0, 0.0).ok(); }));
  EXPECT_EQ(robot->fastest_mmps(), 0.0);
  EXPECT_EQ(fastestDuring(300ms), 0.0);
  EXPECT_EQ(robot->setSpeed_mmps(), 0.0);
  // The robot counts from 0 again; odom goes on.
  const Pose2 after = base().samplesSince(kEverything, 0ms).samples.back().T_odom_robot;
  EXPECT_NEAR(after.x, before.x, 1e-9);
  ASSERT_TRUE(drive(0.2));
}

TEST_F(PioneerTest, WaitsForARobotThatIsNotThereYet) {
  robot->unplug();
  const PortReply reply = base().start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, robot->path() + ": no such device");
  robot->plugIn();
  ASSERT_TRUE(eventually([&] { return robot->motorsOn(); }));
  ASSERT_TRUE(drive(0.2));
}

TEST_F(PioneerTest, ReportsAMissingAnswer) {
  robot->change([](Faults& f) { f.deaf = true; });
  const auto began = Clock::now();
  auto& pioneer = base([](PioneerBase::Params& p) { p.bauds_bps = {9600, 38400}; });
  const PortReply reply = pioneer.start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, robot->path() + ": no robot answers (tried 9600, 38400 bit/s)");
  EXPECT_LT(Clock::now() - began, 5s);
  robot->change([](Faults& f) { f.deaf = false; });
  ASSERT_TRUE(drive(0.2));
}

TEST_F(PioneerTest, SaysWhenWhatAnswersIsNoRobot) {
  robot->change([](Faults& f) { f.wrong_checksums = true; });
  const PortReply reply = base().start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, robot->path() + ": what answers speaks no P2OS (tried 9600 bit/s)");
}

TEST_F(PioneerTest, KeepsOnThroughGarbageOnTheLine) {
  ASSERT_TRUE(base().start().ok());
  for (int i = 0; i < 20; ++i) {
    robot->babble(std::vector<std::uint8_t>{0xFA, 0xFB, 0x09, 0x33, 0xFA, 0x00, 0x7F});
    std::this_thread::sleep_for(10ms);
    EXPECT_TRUE(base().setVelocity(0.3, 0.0).ok());
  }
  ASSERT_TRUE(drive(0.3));
}

TEST_F(PioneerTest, StopsARobotThatSaysNothingAndTakesNoCommandsForIt) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.4));
  robot->change([](Faults& f) { f.silent = true; });
  PortReply reply;
  ASSERT_TRUE(eventually([&] {
    reply = base().setVelocity(0.4, 0.0);
    return !reply.ok();
  }));
  EXPECT_EQ(reply.message, robot->path() + ": the robot says nothing any more");
  EXPECT_EQ(waitingFor(), reply.message);
  // It receives: so it got a stop command.
  ASSERT_TRUE(eventually([&] { return standing(); }));
  ASSERT_TRUE(
      eventually([&] { return waitingFor() == robot->path() + ": no robot answers (tried 9600 bit/s)"; }));
  robot->change([](Faults& f) { f.silent = false; });
  ASSERT_TRUE(drive(0.2));
}

TEST_F(PioneerTest, WantsAFreshStartAfterTheStopButton) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.3));
  robot->change([](Faults& f) { f.stop_button = true; });
  PortReply reply;
  ASSERT_TRUE(eventually([&] {
    reply = base().setVelocity(0.3, 0.0);
    return !reply.ok();
  }));
  EXPECT_EQ(reply.message, "the stop button is pressed");
  ASSERT_TRUE(eventually([&] { return condition() == "the stop button is pressed"; }));
  robot->change([](Faults& f) { f.stop_button = false; });
  // A client that has gone on all the time does not get the robot going.
  robot->fastest_mmps();
  for (int i = 0; i < 30; ++i) {
    std::this_thread::sleep_for(20ms);
    reply = base().setVelocity(0.3, 0.0);
    EXPECT_FALSE(reply.ok());
  }
  EXPECT_EQ(reply.message, "the motors went off: command 0, or nothing for a second, before the next");
  EXPECT_EQ(condition(), "the motors are off");
  EXPECT_FALSE(robot->motorsOn());
  EXPECT_TRUE(base().setVelocity(0.0, 0.0).ok());
  ASSERT_TRUE(drive(0.3));
  ASSERT_TRUE(eventually([&] { return condition().empty(); }));
}

TEST_F(PioneerTest, TakesAPauseForAFreshStartToo) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.2));
  robot->switchMotorsOff();
  ASSERT_TRUE(eventually([&] { return !base().setVelocity(0.2, 0.0).ok(); }));
  std::this_thread::sleep_for(1100ms);
  EXPECT_FALSE(robot->motorsOn()) << "not commanded";
  ASSERT_TRUE(drive(0.2));
}

TEST_F(PioneerTest, ReportsConditionsOfTheRobot) {
  ASSERT_TRUE(base().start().ok());
  EXPECT_EQ(condition(), "");
  robot->change([](Faults& f) { f.left_stalled = true; });
  EXPECT_TRUE(eventually([&] { return condition() == "the left wheel is stalled"; }));
  robot->change([](Faults& f) { f.right_stalled = true; });
  EXPECT_TRUE(eventually([&] { return condition() == "both wheels are stalled"; }));
  robot->change([](Faults& f) {
    f.left_stalled = f.right_stalled = false;
    f.battery_V = 11.2;
  });
  EXPECT_TRUE(eventually([&] { return condition() == "the battery is low: under 11.5 V"; }));
  robot->change([](Faults& f) { f.battery_V = 12.0; });
  EXPECT_TRUE(eventually([&] { return condition().empty(); }));
}

TEST_F(PioneerTest, WarnsOfARobotWithoutAWatchdog) {
  P2osRobot::Traits traits;
  traits.reported_watchdog_ms = 0;
  use(traits);
  ASSERT_TRUE(base().start().ok());
  EXPECT_TRUE(eventually([&] { return condition().starts_with("the robot's own watchdog is off"); }));
}

TEST_F(PioneerTest, AsksForTheScalesOfAnUnknownModel) {
  P2osRobot::Traits traits;
  traits.subclass = "p9xx";
  use(traits);
  EXPECT_EQ(base().start().message,
            robot->path() +
                ": the scales of a Pioneer p9xx are not known: set DistanceUnit_mm and TurnFactor_radpm");
  end();
  auto& pioneer = base([](PioneerBase::Params& p) { p.scale = p2os::Scale{0.84, 0.0056}; });
  EXPECT_EQ(pioneer.start().kind, PortReply::Kind::kAccepted);
}

TEST_F(PioneerTest, StandsWhenItsDriverGoes) {
  ASSERT_TRUE(base().start().ok());
  ASSERT_TRUE(drive(0.4));
  end();
  EXPECT_TRUE(standing());
  EXPECT_TRUE(eventually([&] { return !robot->sessionOpen(); }));
}

TEST_F(PioneerTest, StopsInEveryState) {
  robot->change([](Faults& f) { f.deaf = true; });
  // Into the handshake, into the pause after a failure, while silent, while unplugged.
  // Five rates take over three seconds to be tried.
  PioneerBase& pioneer = base([](PioneerBase::Params& p) {
    p.bauds_bps = {9600, 19200, 38400, 57600, 115200};
  });
  std::jthread starter([&] { pioneer.start(); });
  std::this_thread::sleep_for(100ms);
  auto began = Clock::now();
  pioneer.stop();
  EXPECT_LT(Clock::now() - began, 1s) << "in the middle of a handshake, and of start()";
  starter.join();
  robot->unplug();
  base().start();
  began = Clock::now();
  base().stop();
  EXPECT_LT(Clock::now() - began, 2s);
  robot->plugIn();
  robot->change([](Faults& f) { f.deaf = false; });
  ASSERT_TRUE(base().start().ok());
  robot->unplug();
  began = Clock::now();
  base().stop();
  EXPECT_LT(Clock::now() - began, 3s);
  const PortReply refused = base().setVelocity(0.1, 0.0);
  EXPECT_EQ(refused.message, "the base is stopped");
}

TEST(PioneerKeys, AreCheckedTogether) {
  const auto properties = Properties::parse(
      "Baud_bps=9601\nMaximumSpeed_mps=9\nDistanceUnit_mm=1\nWatchdog_s=0\nPulse=1\n", "robot.cfg");
  ConfigReader config(properties);
  makePioneerBase(config);
  std::string all;
  for (const Problem& problem : config.allProblems()) all += problem.text() + "\n";
  EXPECT_THAT(all, HasSubstr("missing key \"Port\" (must be the robot's serial port, such as /dev/ttyUSB0)"));
  EXPECT_THAT(all,
              HasSubstr("Baud_bps = 9601 (must be a rate of serial ports, such as 9600, or 0 to try all)"));
  EXPECT_THAT(all, HasSubstr("MaximumSpeed_mps = 9 (must be 0.01..2.2)"));
  EXPECT_THAT(all, HasSubstr("DistanceUnit_mm = 1 (must be set together with TurnFactor_radpm)"));
  EXPECT_THAT(all, HasSubstr("Watchdog_s = 0 (must be 0.05..2)"));
  EXPECT_THAT(all, HasSubstr("unknown key \"Pulse\""));
}

}  // namespace
}  // namespace vismem
