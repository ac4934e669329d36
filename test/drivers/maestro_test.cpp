// The Maestro: its requests, and its driver with a controller on umockdev's USB, with the message of each
// failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "common/geometry/angles.h"
#include "drivers/pololu_maestro/maestro_codec.h"
#include "drivers/pololu_maestro/maestro_pan_tilt.h"
#include "drivers/pololu_maestro/maestro_usb.h"
#include "support/emulated_maestro.h"
#include "support/eventually.h"
#include "support/file_permissions.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

TEST(MaestroCodec, AsksAsPololusOwnSoftware) {
  const auto target = maestro::setTarget(2, 6000);
  EXPECT_EQ(target.type, 0x40);
  EXPECT_EQ(target.request, 0x85);
  EXPECT_EQ(target.value, 6000);
  EXPECT_EQ(target.index, 2);
  const auto speed = maestro::setSpeed(3, 40);
  EXPECT_EQ(speed.request, 0x84);
  EXPECT_EQ(speed.value, 40);
  EXPECT_EQ(speed.index, 3);
  const auto* micro = maestro::modelOf(0x1FFB, 0x0089);
  const auto* mini = maestro::modelOf(0x1FFB, 0x008C);
  ASSERT_TRUE(micro && mini);
  EXPECT_EQ(maestro::getServos(*micro).request, 0x83);
  EXPECT_EQ(maestro::getServos(*micro).length, 140);
  EXPECT_EQ(maestro::getServos(*mini).request, 0x87);
  EXPECT_EQ(maestro::getServos(*mini).length, 7 * 24);
  EXPECT_EQ(maestro::modelOf(0x1FFB, 0x0090), nullptr);
  EXPECT_EQ(maestro::modelOf(0x1234, 0x0089), nullptr);
}

TEST(MaestroCodec, ReadsServosOfBothKinds) {
  std::vector<std::uint8_t> bytes(140, 0);
  bytes[2] = 0x12;
  const std::array<std::uint8_t, 7> servo{0x70, 0x17, 0x58, 0x1b, 0x28, 0x00, 0x05};
  std::copy(servo.begin(), servo.end(), bytes.begin() + 98 + 7);
  const auto* micro = maestro::modelOf(0x1FFB, 0x0089);
  const auto state = maestro::parseServos(*micro, bytes);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->errors, 0x12U);
  ASSERT_EQ(state->servos.size(), 6U);
  EXPECT_EQ(state->servos[1].position_qus, 6000);
  EXPECT_EQ(state->servos[1].target_qus, 7000);
  EXPECT_EQ(state->servos[1].speed, 40);
  bytes.pop_back();
  EXPECT_FALSE(maestro::parseServos(*micro, bytes));
}

TEST(MaestroCodec, TurnsAnglesIntoPulses) {
  const maestro::Pulse pulse{1500.0, radToDeg(10.0)};  // 10 us a degree
  EXPECT_EQ(pulse.target_qus(0.0), 6000);
  EXPECT_EQ(pulse.target_qus(degToRad(45.0)), 4 * 1950);
  EXPECT_NEAR(pulse.angle(4 * 1950), degToRad(45.0), 1e-12);
  EXPECT_EQ(pulse.speed(degToRad(100.0)), 40);  // 1000 us/s
  EXPECT_EQ(pulse.speed(1e-9), 1);
  EXPECT_NEAR(radToDeg(pulse.slowest_radps()), 2.5, 1e-12);
  const maestro::Pulse inverted{1500.0, -radToDeg(10.0)};
  EXPECT_EQ(inverted.target_qus(degToRad(45.0)), 4 * 1050);
  EXPECT_EQ(inverted.speed(degToRad(100.0)), 40);
}

class MaestroTest : public testing::Test {
 protected:
  PanTiltUnit& unit(const std::string& keys = "") {
    if (!unit_) {
      const auto properties = Properties::parse(keys, "test.cfg");
      ConfigReader config(properties);
      unit_ = makeMaestroPanTilt(config);
      config.finish();
    }
    return *unit_;
  }
  PortReply position(double pan_deg, double tilt_deg) {
    return unit().command({PanTiltCommand::Kind::kPosition, degToRad(pan_deg), degToRad(tilt_deg), 0.0, 0.0});
  }
  PortReply velocity(double pan_degps, double tilt_degps) {
    return unit().command(
        {PanTiltCommand::Kind::kVelocity, 0.0, 0.0, degToRad(pan_degps), degToRad(tilt_degps)});
  }
  std::string waitingFor() { return unit().samplesSince(std::numeric_limits<StampUs>::max(), 0ms).message; }
  std::string condition() { return unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms).message; }

  EmulatedMaestro device;

 private:
  std::unique_ptr<PanTiltUnit> unit_;
};

TEST_F(MaestroTest, GoesToItsCommandAndStaysWhenStopped) {
  ASSERT_EQ(unit("Pan.Channel=4\nTilt.Channel=2\nTilt.Inverted=yes\nTilt.Centre_us=1400\n").start().message,
            "");
  EXPECT_EQ(device.position_qus(4), 6000) << "a servo that was off goes to 0";
  ASSERT_TRUE(position(30.0, 20.0).ok());
  EXPECT_TRUE(
      eventually([&] { return device.position_qus(4) == 4 * 1800 && device.position_qus(2) == 4 * 1200; }));
  const PortReply slow = velocity(2.0, 1.0);
  EXPECT_EQ(slow.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(slow.message,
            "pan rate 2 deg/s to 2.5 (the slowest is 2.5), tilt rate 1 deg/s to 0 (the slowest is 2.5)");
  ASSERT_TRUE(velocity(-50.0, 0.0).ok());
  EXPECT_TRUE(eventually([&] { return device.position_qus(4) < 4 * 1700; }));
  EXPECT_EQ(device.speed(4), 20);
  unit().stop();
  EXPECT_EQ(velocity(-50.0, 0.0).message, "the pan-tilt unit is stopped");
  const int stands = device.target_qus(4);
  EXPECT_GT(stands, 4 * 900) << "the end of the way was 60 degrees to the right";
  EXPECT_TRUE(eventually([&] { return device.position_qus(4) == stands; }));
}

TEST_F(MaestroTest, ComesBackAfterItWasPulledOut) {
  ASSERT_EQ(unit().start().message, "");
  device.unplug();
  EXPECT_TRUE(eventually([&] { return waitingFor() == "no Maestro is connected"; })) << waitingFor();
  EXPECT_EQ(position(1.0, 1.0).message, "no Maestro is connected");
  device.plugIn();
  EXPECT_TRUE(eventually([&] { return position(10.0, 0.0).ok(); }));
  EXPECT_TRUE(eventually([&] { return device.position_qus(0) == 4 * 1600; }));
}

TEST_F(MaestroTest, ReportsATransferThatItWasUnplugged) {
  maestro::Usb usb;
  ASSERT_EQ(usb.open(""), "");
  ASSERT_EQ(usb.transfer(maestro::setTarget(0, 6000)), "");
  device.unplug();
  EXPECT_EQ(usb.transfer(maestro::setTarget(0, 6000)), "the Maestro was unplugged");
}

TEST_F(MaestroTest, WaitsForTheOneWithItsSerialNumber) {
  EXPECT_EQ(unit("Serial=777\n").start().message,
            "no Maestro with the serial number 777 is connected (there are: 00012345)");
  const auto properties = Properties::parse("Serial=00012345\n", "test.cfg");
  ConfigReader config(properties);
  EXPECT_EQ(makeMaestroPanTilt(config)->start().message, "");
}

TEST_F(MaestroTest, AsksWhichOfSeveralIsMeant) {
  const EmulatedMaestro second(0x008A, "00067890", 2);
  EXPECT_EQ(unit().start().message,
            "several Maestros are connected: set Serial to one of 00012345, 00067890");
  const auto properties = Properties::parse("Serial=00067890\nTilt.Channel=11\n", "test.cfg");
  ConfigReader config(properties);
  EXPECT_EQ(makeMaestroPanTilt(config)->start().message, "") << "a Mini Maestro 12 has channel 11";
}

TEST_F(MaestroTest, SaysWhatGivesPermission) {
  const FilePermissionsCount permissions_count;
  device.forbid();
  const std::string why =
      "no permission for the Micro Maestro 6 (bus 1 device 2): a udev rule gives it (docs/hardware.md)";
  EXPECT_EQ(unit().start().message, why);
  EXPECT_EQ(position(1.0, 1.0).message, why);
  device.forbid(false);
  EXPECT_TRUE(eventually([&] { return position(10.0, 0.0).ok(); })) << waitingFor();
}

TEST_F(MaestroTest, SaysWhatTheDeviceDoesNotDo) {
  EXPECT_EQ(unit("Tilt.Channel=7\n").start().message, "a Micro Maestro 6 has no channel 7 (they are 0..5)");
}

TEST_F(MaestroTest, ReportsRefusalsSilenceAndShortAnswers) {
  ASSERT_EQ(unit().start().message, "");
  device.refuse(0x83);
  EXPECT_TRUE(eventually([&] { return waitingFor() == "the Maestro refuses request 0x83"; })) << waitingFor();
  device.refuse(0);
  EXPECT_TRUE(eventually([&] { return position(1.0, 1.0).ok(); }));
  device.setSilent(true);
  EXPECT_TRUE(eventually([&] { return waitingFor() == "the Maestro says nothing any more"; }))
      << waitingFor();
  device.setSilent(false);
  EXPECT_TRUE(eventually([&] { return position(1.0, 1.0).ok(); }));
  device.setShortAnswers(true);
  EXPECT_TRUE(eventually([&] { return waitingFor() == "the Maestro's answer is too short"; }))
      << waitingFor();
  device.setShortAnswers(false);
  EXPECT_TRUE(eventually([&] { return position(1.0, 1.0).ok(); }));
}

TEST_F(MaestroTest, ReportsConditionsOfTheDevice) {
  ASSERT_EQ(unit().start().message, "");
  EXPECT_EQ(condition(), "");
  device.setErrors(0x11);
  EXPECT_TRUE(eventually([&] { return condition() == "the Maestro reports errors, bits 0x11"; }))
      << condition();
  device.setErrors(0);
  EXPECT_TRUE(eventually([&] { return condition().empty(); }));
  device.switchOff(1);
  EXPECT_TRUE(eventually(
      [&] { return condition() == "the tilt servo is switched off (by a script of the Maestro?)"; }));
}

TEST(MaestroAbsent, IsWaitedFor) {
  const auto properties = Properties::parse("", "test.cfg");
  ConfigReader config(properties);
  EmulatedMaestro device;
  device.unplug();
  const auto unit = makeMaestroPanTilt(config);
  const PortReply reply = unit->start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, "no Maestro is connected");
}

TEST(MaestroKeys, AreCheckedTogether) {
  const auto properties =
      Properties::parse("Pan.Channel=3\nTilt.Channel=3\nTilt.Minimum_deg=50\nPan.Centre_us=10\n", "r.cfg");
  ConfigReader config(properties);
  makeMaestroPanTilt(config);
  std::string all;
  for (const Problem& problem : config.allProblems()) all += problem.text() + "\n";
  EXPECT_THAT(all, HasSubstr("r.cfg:2: Tilt.Channel = 3 (must be another than Pan.Channel)"));
  EXPECT_THAT(all, HasSubstr("r.cfg:3: Tilt.Minimum_deg = 50 (must be less than Tilt.Maximum_deg)"));
  EXPECT_THAT(all, HasSubstr("r.cfg:4: Pan.Centre_us = 10 (must be 500..2500)"));
}

}  // namespace
}  // namespace vismem
