// The PTU-46: its replies, and its driver with a unit on a pseudo terminal, with the message of each failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "common/geometry/angles.h"
#include "drivers/ptu46/ptu46_codec.h"
#include "drivers/ptu46/ptu46_unit.h"
#include "support/eventually.h"
#include "support/ptu46_device.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ptu46::Axis;
using ptu46::Reply;
using testing::Contains;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using Faults = Ptu46Device::Faults;

constexpr double kStep_rad = 185.142853 / 3600.0 * std::numbers::pi / 180.0;

std::vector<Reply> repliesIn(const std::string& stream, std::size_t piece) {
  ptu46::ReplyReader reader;
  std::vector<Reply> found;
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    const std::string part = stream.substr(at, piece);
    reader.add(std::vector<std::uint8_t>(part.begin(), part.end()));
    while (const auto reply = reader.next()) found.push_back(*reply);
  }
  return found;
}

TEST(Ptu46Codec, WritesCommands) {
  EXPECT_EQ(ptu46::query(Axis::kPan, ptu46::kPosition), "PP ");
  EXPECT_EQ(ptu46::query(Axis::kTilt, ptu46::kResolution), "TR ");
  EXPECT_EQ(ptu46::set(Axis::kPan, ptu46::kPosition, -500), "PP-500 ");
  EXPECT_EQ(ptu46::set(Axis::kTilt, ptu46::kSpeed, 1000), "TS1000 ");
}

TEST(Ptu46Codec, FindsRepliesHoweverTheyAreCut) {
  // Echo, a sentence, a limit switch that speaks into it, an error, a terse number, a reset.
  const std::string stream =
      "PP * Current Pan posi!Ption is -12\r\n!TTP9999 ! Maximum allowable Tilt position is 604\r\n* 7\r\n"
      "!T!T!P!P*\r\n";
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    const auto replies = repliesIn(stream, piece);
    std::vector<std::string> texts;
    int pan_limits = 0;
    int tilt_limits = 0;
    for (const Reply& reply : replies) {
      pan_limits += reply.kind == Reply::Kind::kPanLimit;
      tilt_limits += reply.kind == Reply::Kind::kTiltLimit;
      if (reply.kind == Reply::Kind::kDone) texts.push_back("done " + reply.text);
      if (reply.kind == Reply::Kind::kError) texts.push_back("error " + reply.text);
    }
    EXPECT_THAT(texts,
                testing::ElementsAre("done Current Pan position is -12",
                                     "error Maximum allowable Tilt position is 604", "done 7", "done "))
        << "in pieces of " << piece;
    EXPECT_EQ(pan_limits, 3);
    EXPECT_EQ(tilt_limits, 3);
  }
}

TEST(Ptu46Codec, FindsTheNumberInASentence) {
  EXPECT_EQ(ptu46::numberIn("Current Pan position is -12"), -12.0);
  EXPECT_EQ(ptu46::numberIn("185.142853 seconds arc per Pan position"), 185.142853);
  EXPECT_EQ(ptu46::numberIn("7"), 7.0);
  EXPECT_EQ(ptu46::numberIn("between 1 and 2"), std::nullopt);
  EXPECT_EQ(ptu46::numberIn("nan or inf"), std::nullopt);
  EXPECT_EQ(ptu46::numberIn(""), std::nullopt);
}

TEST(Ptu46Codec, LetsGoOfGarbageThatNeverEnds) {
  ptu46::ReplyReader reader;
  const std::string noise = "*" + std::string(5000, 'x');
  reader.add(std::vector<std::uint8_t>(noise.begin(), noise.end()));
  EXPECT_FALSE(reader.next());
  EXPECT_GT(reader.otherBytes(), 4000U);
  const std::string reply = "\r\n* 3\r\n";
  reader.add(std::vector<std::uint8_t>(reply.begin(), reply.end()));
  const auto found = reader.next();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->text, "3");
}

class Ptu46Test : public testing::Test {
 protected:
  Ptu46Unit& unit(const std::function<void(Ptu46Unit::Params&)>& change = [](auto&) {}) {
    if (!unit_) {
      Ptu46Unit::Params params;
      params.port = device.path();
      change(params);
      unit_ = std::make_unique<Ptu46Unit>(params);
    }
    return *unit_;
  }
  PortReply position(double pan_rad, double tilt_rad) {
    return unit().command({PanTiltCommand::Kind::kPosition, pan_rad, tilt_rad, 0.0, 0.0});
  }
  PortReply velocity(double pan_radps, double tilt_radps) {
    return unit().command({PanTiltCommand::Kind::kVelocity, 0.0, 0.0, pan_radps, tilt_radps});
  }
  std::string waitingFor() { return unit().samplesSince(std::numeric_limits<StampUs>::max(), 0ms).message; }
  std::string condition() { return unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms).message; }

  Ptu46Device device;

 private:
  std::unique_ptr<Ptu46Unit> unit_;
};

TEST_F(Ptu46Test, GoesToItsCommandInTheUnitsSteps) {
  ASSERT_EQ(unit().start().kind, PortReply::Kind::kAccepted);
  EXPECT_NEAR(unit().limits().max_pan_rad, 2.7, 1e-12);
  ASSERT_TRUE(position(1000 * kStep_rad, -500 * kStep_rad).ok());
  EXPECT_TRUE(eventually([&] { return device.position()[0] == 1000.0 && device.position()[1] == -500.0; }));
  EXPECT_THAT(device.heard(), Contains("PP1000"));
  // Slower than the unit can: the nearest that it can.
  const PortReply slow = velocity(20 * kStep_rad, 10 * kStep_rad);
  EXPECT_EQ(slow.kind, PortReply::Kind::kAdjusted);
  EXPECT_THAT(slow.message, HasSubstr("pan rate 1.02857 deg/s to 1.59429 (the slowest is 1.59429)"));
  EXPECT_THAT(slow.message, HasSubstr("tilt rate 0.514286 deg/s to 0 ("));
  EXPECT_TRUE(eventually([&] { return device.position()[0] > 1002.0; }));
  unit().stop();
  EXPECT_FALSE(device.moves());
  EXPECT_EQ(velocity(0.1, 0.0).message, "the pan-tilt unit is stopped");
}

TEST_F(Ptu46Test, HasSignsZerosAndTheUnitsOwnLimits) {
  ASSERT_TRUE(unit([](Ptu46Unit::Params& p) {
                p.pan = {-3.1, 3.1, 9.0, {0.1, true}};
                p.tilt = {-1.5, 1.5, 9.0, {-0.1, false}};
              })
                  .start()
                  .ok());
  const PanTiltLimits limits = unit().limits();
  EXPECT_NEAR(limits.max_pan_rad, 3090 * kStep_rad + 0.1, 1e-9);
  EXPECT_NEAR(limits.min_pan_rad, -3090 * kStep_rad + 0.1, 1e-9);
  EXPECT_NEAR(limits.min_tilt_rad, -907 * kStep_rad + 0.1, 1e-9);
  EXPECT_NEAR(limits.max_pan_rate_radps, 2902 * kStep_rad, 1e-9);
  ASSERT_TRUE(position(0.5, 0.3).ok());
  EXPECT_TRUE(eventually([&] {
    return std::abs(device.position()[0] - (-0.5 + 0.1) / kStep_rad) < 1.0 &&
           std::abs(device.position()[1] - (0.3 - 0.1) / kStep_rad) < 1.0;
  }));
  EXPECT_TRUE(eventually([&] {
    const auto samples = unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms).samples;
    return std::abs(samples.back().pan_rad - 0.5) < 1e-3 && std::abs(samples.back().tilt_rad - 0.3) < 1e-3;
  }));
}

TEST_F(Ptu46Test, FindsItsZeroFirstWhenAsked) {
  device.change([](Faults& f) { f.reset_time = 300ms; });
  ASSERT_EQ(unit([](Ptu46Unit::Params& p) { p.reset = true; }).start().kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(waitingFor(), device.path() + ": the pan-tilt unit finds its zero");
  EXPECT_EQ(velocity(0.1, 0.0).message, device.path() + ": the pan-tilt unit finds its zero");
  EXPECT_TRUE(eventually([&] { return velocity(0.1, 0.0).ok(); }));
  EXPECT_EQ(condition(), "") << "the limit switches of the search are none";
}

TEST_F(Ptu46Test, ReportsLimitSwitchesAndRefusals) {
  ASSERT_TRUE(unit().start().ok());
  device.refuse("PP", "Pan axis is disabled");
  // Its own questions for the angle are refused too: that is what it answers.
  EXPECT_TRUE(eventually(
      [&] { return condition() == "the unit answered \"Pan axis is disabled\" and \"0\" for its angles"; }));
  device.refuse("PS", "Pan speed is out of range");
  ASSERT_TRUE(position(0.1, 0.0).ok());
  EXPECT_TRUE(
      eventually([&] { return condition() == "the unit refused a command: Pan speed is out of range"; }));
  device.refuse("", "");
  ASSERT_TRUE(position(0.2, 0.0).ok());
  EXPECT_TRUE(eventually([&] { return condition().empty(); }));
  device.say("!P");
  EXPECT_TRUE(
      eventually([&] { return condition() == "pan ran into its limit switch: its zero may be lost"; }));
}

TEST_F(Ptu46Test, ComesBackAfterItWasPulledOut) {
  ASSERT_TRUE(unit().start().ok());
  device.unplug();
  EXPECT_TRUE(eventually([&] { return waitingFor() == device.path() + ": no such device"; }));
  EXPECT_EQ(position(0.1, 0.0).message, device.path() + ": no such device");
  device.plugIn();
  EXPECT_TRUE(eventually([&] { return position(0.1, 0.0).ok(); }));
  EXPECT_TRUE(eventually([&] { return device.position()[0] > 100.0; }));
}

TEST_F(Ptu46Test, ReportsMissingAnswersAndThoseOfOtherDevices) {
  device.change([](Faults& f) { f.deaf = true; });
  EXPECT_EQ(unit().start().message, device.path() + ": no pan-tilt unit answers (9600 bit/s)");
  device.change([](Faults& f) {
    f.deaf = false;
    f.garbled = true;
  });
  EXPECT_TRUE(eventually(
      [&] { return waitingFor() == device.path() + ": what answers is no pan-tilt unit (9600 bit/s)"; }));
  device.change([](Faults& f) { f.garbled = false; });
  EXPECT_TRUE(eventually([&] { return position(0.1, 0.0).ok(); }));
}

TEST_F(Ptu46Test, SaysWhenItFallsSilentAndGoesOnAfterwards) {
  ASSERT_TRUE(unit().start().ok());
  device.change([](Faults& f) { f.silent = true; });
  EXPECT_TRUE(eventually(
      [&] { return waitingFor() == device.path() + ": the pan-tilt unit says nothing any more"; }));
  device.change([](Faults& f) { f.silent = false; });
  EXPECT_TRUE(eventually([&] { return position(0.1, 0.0).ok(); }));
}

TEST_F(Ptu46Test, KeepsOnThroughGarbageOnTheLine) {
  ASSERT_TRUE(unit().start().ok());
  for (int i = 0; i < 10; ++i) {
    device.say("* 77 gar\x80 bage\r\n~~\r\n");
    std::this_thread::sleep_for(20ms);
  }
  ASSERT_TRUE(
      eventually([&] { return position(300 * kStep_rad, 0.0).ok() && device.position()[0] == 300.0; }));
  EXPECT_TRUE(eventually([&] {
    const auto samples = unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms).samples;
    return std::abs(samples.back().pan_rad - 300 * kStep_rad) < 1e-6 && samples.back().tilt_rad == 0.0;
  }));
}

TEST_F(Ptu46Test, ReportsAnInvalidRange) {
  device.change([](Faults& f) { f.no_range = true; });
  EXPECT_EQ(unit().start().message, device.path() + ": the unit reports an invalid range");
  device.change([](Faults& f) { f.no_range = false; });
  EXPECT_TRUE(eventually([&] { return unit().command({}).ok(); }));
}

TEST_F(Ptu46Test, StopsInTheMiddleOfAReset) {
  device.change([](Faults& f) { f.reset_time = 25s; });
  ASSERT_TRUE(unit([](Ptu46Unit::Params& p) { p.reset = true; }).start().ok());
  const auto began = Clock::now();
  unit().stop();
  EXPECT_LT(Clock::now() - began, 4s);
}

TEST(Ptu46Keys, AreCheckedTogether) {
  const auto properties = Properties::parse(
      "Port=/dev/x\nBaud_bps=9601\nPan.Minimum_deg=20\nPan.Maximum_deg=10\n"
      "Tilt.Rat_degps=5\n",
      "robot.cfg");
  ConfigReader config(properties);
  makePtu46Unit(config);
  std::string all;
  for (const Problem& problem : config.allProblems()) all += problem.text() + "\n";
  EXPECT_THAT(all, HasSubstr("robot.cfg:2: Baud_bps = 9601 (must be a rate of serial ports, such as 9600)"));
  EXPECT_THAT(all, HasSubstr("robot.cfg:3: Pan.Minimum_deg = 20 (must be less than Pan.Maximum_deg)"));
  EXPECT_THAT(all, HasSubstr("unknown key \"Tilt.Rat_degps\" (did you mean \"Tilt.Rate_degps\"?)"));
}

}  // namespace
}  // namespace vismem
