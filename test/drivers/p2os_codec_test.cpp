// The packets of P2OS: comparison with bytes of Player and AriaCoda, and damaged streams.
#include "drivers/pioneer_p2os/p2os_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/geometry/angles.h"

namespace vismem::p2os {
namespace {

using testing::ElementsAre;

Bytes hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// A packet of information as a p2dx gives it while it drives, with two sonars and ARCOS's tail.
Bytes sipData() {
  return hex(
      "33"  // moving
      "ff7f"
      "0a80"  // x 32767, y 10 with a bit that does not count
      "00fc"  // heading -1024: a quarter to the right
      "c800"
      "9cff"  // 200 and -100 mm/s
      "7d"    // 12.5 V
      "03"
      "04"  // left: stalled, a bumper; right: a bumper
      "0000"
      "2100"  // set point; motors on and stop button
      "2d"    // compass
      "02"
      "00e803"
      "01d007"
      "0000000000"  // gripper and inputs
      "0701");      // 26.3 V
}

TEST(P2osCodec, SendsWhatOthersSend) {
  EXPECT_EQ(sync(0), hex("fafb03000000"));
  EXPECT_EQ(sync(1), hex("fafb03010001"));
  EXPECT_EQ(sync(2), hex("fafb03020002"));
  EXPECT_EQ(command(Command::kOpen), hex("fafb03010001"));
  EXPECT_EQ(command(Command::kClose), hex("fafb03020002"));
  EXPECT_EQ(command(Command::kPulse), hex("fafb03000000"));
  EXPECT_EQ(command(Command::kSpeed, 200), hex("fafb060b3bc800d33b"));
  // 0b1b + c800 = d31b: the magnitude travels, its sign is the argument's type.
  EXPECT_EQ(command(Command::kSpeed, -200), hex("fafb060b1bc800d31b"));
  EXPECT_EQ(command(Command::kSpeed, 0), hex("fafb060b3b00000b3b"));
  EXPECT_EQ(command(Command::kEnable, 1), hex("fafb06043b0100053b"));
  // 253 deg/s and more take both bytes of the argument: 0x012c.
  EXPECT_EQ(command(Command::kTurnRate, 300), hex("fafb06153b2c01413c"));
  EXPECT_EQ(command(Command::kSetAcceleration, -1'000'000), hex("fafb06051bffff051a"));
}

TEST(P2osCodec, SumsWordsAndXorsTheLastOddByte) {
  EXPECT_EQ(checksum(hex("0b3bc800")), 0xd33b);
  EXPECT_EQ(checksum(hex("05")), 0x0005);
  EXPECT_EQ(checksum(hex("010203")), 0x0101);    // 0x0102 ^ 0x03
  EXPECT_EQ(checksum(hex("ffff0002")), 0x0001);  // modulo 65536
  EXPECT_EQ(checksum({}), 0);
}

TEST(P2osCodec, FindsPacketsHoweverTheyAreCut) {
  Bytes stream = packet(sipData());
  const Bytes pulse = command(Command::kPulse);
  stream.insert(stream.end(), pulse.begin(), pulse.end());
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    PacketReader reader;
    std::vector<Bytes> found;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      reader.add(BytesView(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (auto data = reader.next()) found.push_back(*data);
    }
    EXPECT_THAT(found, ElementsAre(sipData(), Bytes{0})) << "in pieces of " << piece;
    EXPECT_EQ(reader.garbageBytes(), 0U);
  }
}

TEST(P2osCodec, FindsPacketsBehindGarbageAndDamage) {
  PacketReader reader;
  Bytes damaged = packet(sipData());
  damaged[5] ^= 0x10U;
  // Half a header, a header with an absurd length, a length that promises more than comes.
  for (const Bytes& bytes : {hex("00ff41fa"), hex("fafafbff"), damaged, hex("fafb01"), packet(sipData())}) {
    reader.add(bytes);
  }
  EXPECT_EQ(reader.next(), sipData());
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_EQ(reader.wrongChecksums(), 1U);
  EXPECT_GT(reader.garbageBytes(), 8U);
  reader.add(hex("fafb"));
  reader.reset();
  reader.add(packet(hex("00")));
  EXPECT_EQ(reader.next(), Bytes{0});
}

TEST(P2osCodec, SurvivesNoiseAndLosesNothingBehindIt) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> byte(0, 255);
  PacketReader reader;
  for (int i = 0; i < 20'000; ++i) {
    Bytes noise(1);
    noise[0] = static_cast<std::uint8_t>(byte(random));
    reader.add(noise);
    while (reader.next()) {
    }
  }
  // A header in the noise may promise 197 bytes at most.
  reader.add(Bytes(200, 0));
  while (reader.next()) {
  }
  reader.add(packet(sipData()));
  EXPECT_EQ(reader.next(), sipData());
}

TEST(P2osCodec, ReadsTheInformationPacket) {
  const auto sip = parseSip(sipData());
  ASSERT_TRUE(sip);
  EXPECT_TRUE(sip->moving);
  EXPECT_EQ(sip->x, 32767);
  EXPECT_EQ(sip->y, 10);
  EXPECT_EQ(sip->heading, -1024);
  EXPECT_EQ(sip->left_mmps, 200);
  EXPECT_EQ(sip->right_mmps, -100);
  EXPECT_DOUBLE_EQ(sip->battery_V, 26.3);
  EXPECT_TRUE(sip->left_stalled);
  EXPECT_FALSE(sip->right_stalled);
  EXPECT_EQ(sip->left_bumpers, 2);
  EXPECT_EQ(sip->right_bumpers, 4);
  EXPECT_TRUE(sip->motors_on);
  EXPECT_TRUE(sip->stop_button);
  EXPECT_DOUBLE_EQ(forwardSpeed(*sip), 0.05);
  EXPECT_DOUBLE_EQ(turnRate(*sip, {0.84, 0.0056}), -0.84);  // -150 mm/s * 0.0056 rad/m

  // P2OS gives no more than a byte of battery.
  const Bytes data = sipData();
  const auto shorter = parseSip(BytesView(data).first(data.size() - 2));
  ASSERT_TRUE(shorter);
  EXPECT_DOUBLE_EQ(shorter->battery_V, 12.5);
}

TEST(P2osCodec, RefusesPacketsThatEndTooSoonOrAreOthers) {
  const Bytes data = sipData();
  for (std::size_t size = 0; size < 26; ++size) EXPECT_FALSE(parseSip(BytesView(data).first(size))) << size;
  EXPECT_TRUE(parseSip(BytesView(data).first(26)));
  EXPECT_FALSE(parseSip(hex("20")));
  EXPECT_FALSE(parseConfig(data));
  EXPECT_FALSE(parseConfig(hex("2041")));
  EXPECT_FALSE(parseIdentity(hex("02415000")));
}

TEST(P2osCodec, ReadsWhoTheRobotIs) {
  const auto robot = parseIdentity(hex("0253696d426f740050696f6e656572007032647800"));
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->name, "SimBot");
  EXPECT_EQ(robot->robot_class, "Pioneer");
  EXPECT_EQ(robot->subclass, "p2dx");
  ASSERT_TRUE(scaleOf("p2dx"));
  EXPECT_EQ(scaleOf("p2dx")->mm_per_unit, 0.84);
  EXPECT_FALSE(scaleOf("p9"));
}

TEST(P2osCodec, ReadsTheRobotsSettings) {
  const auto config =
      parseConfig(hex("20"
                      "50696f6e65657200"
                      "7032647800"
                      "4142433100"
                      "00"
                      "6801"
                      "9808"
                      "2c01"
                      "d007"
                      "f401"
                      "426f7400"
                      "64"
                      "0001"
                      "0100"
                      "0100"
                      "00"
                      "6e00"
                      "c03b"
                      "d007"
                      "03"));
  ASSERT_TRUE(config);
  EXPECT_EQ(config->type, "Pioneer");
  EXPECT_EQ(config->subtype, "p2dx");
  EXPECT_EQ(config->serial_number, "ABC1");
  EXPECT_EQ(config->max_turn_rate_degps, 360);
  EXPECT_EQ(config->max_speed_mmps, 2200);
  EXPECT_EQ(config->name, "Bot");
  EXPECT_EQ(config->sip_cycle_ms, 100);
  EXPECT_DOUBLE_EQ(config->low_battery_V, 11.0);
  EXPECT_EQ(config->watchdog_ms, 2000);
}

TEST(P2osOdometry, GoesOnWhenCountersRollOver) {
  Odometry odometry({2.0, 0.0056});  // 2 mm a unit
  Sip sip;
  sip.x = 32767 - 99;
  sip.y = 50;
  EXPECT_EQ(odometry.add(sip), Pose2{});
  sip.x = 400;          // 500 on
  sip.y = 32767 - 149;  // 200 back
  const Pose2 pose = odometry.add(sip);
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, -0.4, 1e-12);
}

TEST(P2osOdometry, FollowsACircleOverManyTurnsAndStaysOnIt) {
  Odometry odometry({1.0, 0.0056});
  Pose2 last;
  constexpr double kRadius_mm = 9000.0;
  for (int i = 0; i <= 40 * 360; ++i) {
    const double angle = degToRad(i);
    Sip sip;
    sip.x = static_cast<std::uint16_t>(std::lround(kRadius_mm * std::sin(angle)) & 0x7FFF);
    sip.y = static_cast<std::uint16_t>(std::lround(kRadius_mm * (1.0 - std::cos(angle))) & 0x7FFF);
    sip.heading = static_cast<std::int16_t>(std::lround(angle / (2.0 * std::numbers::pi) * 4096.0) % 4096);
    last = odometry.add(sip);
  }
  EXPECT_NEAR(last.x, 0.0, 2e-3);
  EXPECT_NEAR(last.y, 0.0, 2e-3);
  EXPECT_NEAR(last.theta, 0.0, 2e-3);
}

TEST(P2osOdometry, GoesOnFromWhereItWasWhenTheRobotCountsAnew) {
  Odometry odometry({1.0, 0.0056});
  Sip sip;
  odometry.add(sip);
  sip.x = 1000;
  sip.heading = 1024;  // a quarter to the left
  odometry.add(sip);
  odometry.restart();
  sip = {};
  EXPECT_NEAR(odometry.add(sip).x, 1.0, 1e-12);
  sip.x = 500;  // forward, which is to the left of where it began
  const Pose2 pose = odometry.add(sip);
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 0.5, 1e-12);
  EXPECT_NEAR(pose.theta, 0.5 * std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace vismem::p2os
