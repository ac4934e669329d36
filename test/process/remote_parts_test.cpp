// What a process offers to remote readers, without Ice: log, parameters, processor time, identities.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <stdexcept>

#include "common/config/properties.h"
#include "common/process/cpu_meter.h"
#include "common/process/log.h"
#include "common/process/log_ring.h"
#include "common/process/parameter_table.h"
#include "common/process/ready_line.h"
#include "common/process/robot_identity.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> textsOf(const LogRing::Batch& batch) {
  std::vector<std::string> texts;
  for (const auto& message : batch.messages) texts.push_back(message.text);
  return texts;
}

TEST(LogRing, GivesWhatIsNewerAndNotBelowTheLevel) {
  LogRing ring;
  ring.add(LogLevel::kInfo, 10, "one");
  ring.add(LogLevel::kError, 20, "two");
  ring.add(LogLevel::kDebug, 30, "three");
  const auto all = ring.since(0, LogLevel::kDebug, 100);
  EXPECT_THAT(textsOf(all), ElementsAre("one", "two", "three"));
  EXPECT_EQ(all.messages[1].seq, 2);
  EXPECT_EQ(all.messages[1].stamp_us, 20);
  EXPECT_EQ(all.last_seq, 3);
  EXPECT_EQ(all.lost, 0);
  const auto warnings = ring.since(1, LogLevel::kWarning, 100);
  EXPECT_THAT(textsOf(warnings), ElementsAre("two"));
  EXPECT_EQ(warnings.last_seq, 3) << "what was passed over is not asked for again";
  EXPECT_THAT(textsOf(ring.since(3, LogLevel::kDebug, 100)), IsEmpty());
}

TEST(LogRing, GivesLongAnswersInParts) {
  LogRing ring;
  for (int i = 1; i <= 5; ++i) ring.add(i % 2 ? LogLevel::kWarning : LogLevel::kInfo, i, std::to_string(i));
  const auto first = ring.since(0, LogLevel::kWarning, 2);
  EXPECT_THAT(textsOf(first), ElementsAre("1", "3"));
  EXPECT_EQ(first.last_seq, 3);
  EXPECT_THAT(textsOf(ring.since(first.last_seq, LogLevel::kWarning, 2)), ElementsAre("5"));
}

TEST(LogRing, ARestartedProcessGivesAll) {
  LogRing ring;
  ring.add(LogLevel::kInfo, 1, "first after the restart");
  EXPECT_THAT(textsOf(ring.since(812, LogLevel::kDebug, 10)), ElementsAre("first after the restart"));
  EXPECT_THAT(textsOf(ring.since(-5, LogLevel::kDebug, 10)), ElementsAre("first after the restart"));
  EXPECT_EQ(LogRing().since(7, LogLevel::kDebug, 10).last_seq, 0);
}

TEST(LogRing, IsBoundedAndCountsWhatIsLost) {
  LogRing ring;
  const int total = static_cast<int>(LogRing::kCapacity) + 30;
  for (int i = 1; i <= total; ++i) ring.add(LogLevel::kInfo, i, "m");
  const auto batch = ring.since(10, LogLevel::kDebug, 10'000);
  EXPECT_EQ(batch.messages.size(), LogRing::kCapacity);
  EXPECT_EQ(batch.messages.front().seq, 31);
  EXPECT_EQ(batch.lost, 20);
  EXPECT_EQ(ring.since(40, LogLevel::kDebug, 1).lost, 0);
}

TEST(LogRing, CutsLongTextsBetweenCharacters) {
  LogRing ring;
  std::string text(LogRing::kLongestText_bytes - 1, 'x');
  ring.add(LogLevel::kInfo, 1, text + "\u00e9");  // two bytes, of which one would fit
  EXPECT_EQ(ring.since(0, LogLevel::kDebug, 1).messages.at(0).text, text);
}

TEST(LoggerHistory, HoldsWhatWasWrittenWithoutSecrets) {
  std::ostringstream lines;
  Logger log("eye", LogLevel::kInfo, lines, [] { return "T"; });
  log.conceal("S3cretTokenOfToday");
  log.conceal("");
  log.debug("below the level");
  log.warning("identity robot.S3cretTokenOfToday/Motors and S3cretTokenOfToday\nagain S3cretTokenOfToday");
  EXPECT_EQ(lines.str(), "T eye WARNING identity robot.***/Motors and ***\n    again ***\n");
  const auto batch = log.history().since(0, LogLevel::kDebug, 10);
  ASSERT_EQ(batch.messages.size(), 1u);
  EXPECT_EQ(batch.messages[0].text, "identity robot.***/Motors and ***\n    again ***");
  EXPECT_EQ(batch.messages[0].level, LogLevel::kWarning);
  EXPECT_GT(batch.messages[0].stamp_us, 1'600'000'000'000'000) << "real time";
}

TEST(CpuMeter, IsTheShareOfOneCoreOverTheWindow) {
  CpuMeter meter(2s);
  SteadyTime now{100s};
  EXPECT_EQ(meter.percent(), 0.0);
  meter.add(now, 5.0);
  EXPECT_EQ(meter.percent(), 0.0) << "one reading says nothing";
  meter.add(now + 1s, 5.5);
  EXPECT_DOUBLE_EQ(meter.percent(), 50.0);
  for (int i = 2; i <= 6; ++i) meter.add(now + i * 1s, 5.5 + 2.0 * (i - 1));
  EXPECT_DOUBLE_EQ(meter.percent(), 200.0) << "two cores, and the quiet second is out of the window";
}

TEST(CpuMeter, ReadsTheTimeOfThisProcess) {
  const double before_s = processorTime_s();
  volatile double sum = 0.0;
  while (processorTime_s() < before_s + 0.01) sum = sum + 1.0;
  EXPECT_GT(processorTime_s(), before_s);
}

class Parameters : public testing::Test {
 protected:
  Parameters() {
    table.add({"Overlay.Rate_hz", "Hz", 0.5, 60.0, false, 10.0, "rate"}, [this](double value) {
      applied.push_back(value);
      return value == 13.0 ? std::string("13 brings bad luck") : std::string();
    });
    table.add({"Log.Level", "", 0.0, 3.0, true, 1.0, "level"}, [](double) { return std::string(); });
  }
  using Kind = ParameterTable::Outcome::Kind;
  ParameterTable table;
  std::vector<double> applied;
};

TEST_F(Parameters, AreListedInOrderWithTheirConfiguredValues) {
  const auto list = table.list();
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].parameter.name, "Overlay.Rate_hz");
  EXPECT_EQ(list[0].value, 10.0);
  EXPECT_EQ(list[1].parameter.name, "Log.Level");
}

TEST_F(Parameters, AreHandedToTheirOwner) {
  EXPECT_EQ(table.set("Overlay.Rate_hz", 60.0).kind, Kind::kAccepted);
  EXPECT_THAT(applied, ElementsAre(60.0));
  EXPECT_EQ(table.list()[0].value, 60.0);
  EXPECT_EQ(table.list()[0].parameter.configured, 10.0);
}

TEST_F(Parameters, OutsideTheirRangeChangeNothing) {
  const auto above = table.set("Overlay.Rate_hz", 60.5);
  EXPECT_EQ(above.kind, Kind::kInvalid);
  EXPECT_EQ(above.reason, "Overlay.Rate_hz = 60.5 (must be 0.5..60 [Hz])");
  EXPECT_EQ(table.set("Overlay.Rate_hz", std::numeric_limits<double>::quiet_NaN()).kind, Kind::kInvalid);
  EXPECT_EQ(table.set("Overlay.Rate_hz", -std::numeric_limits<double>::infinity()).kind, Kind::kInvalid);
  EXPECT_EQ(table.set("Log.Level", 1.5).reason, "Log.Level = 1.5 (must be 0..3, whole)");
  EXPECT_EQ(table.set("Log.level", 1.0).reason, "no parameter is called \"Log.level\"");
  EXPECT_THAT(applied, IsEmpty());
  EXPECT_EQ(table.list()[0].value, 10.0);
}

TEST_F(Parameters, RefusedByTheOwnerKeepTheirValue) {
  const auto outcome = table.set("Overlay.Rate_hz", 13.0);
  EXPECT_EQ(outcome.kind, Kind::kRefused);
  EXPECT_EQ(outcome.reason, "13 brings bad luck");
  EXPECT_EQ(table.list()[0].value, 10.0);
}

TEST_F(Parameters, MustBeListedOnceAndStartInTheirRange) {
  const auto nothing = [](double) { return std::string(); };
  EXPECT_THROW(table.add({"Log.Level", "", 0.0, 3.0, true, 1.0, ""}, nothing), std::logic_error);
  EXPECT_THROW(table.add({"New", "", 0.0, 3.0, false, 4.0, ""}, nothing), std::logic_error);
}

TEST(RobotIdentity, EachKeyHasAMeaning) {
  const Properties none;
  ConfigReader config(none);
  readRobotKeys(config);
  EXPECT_EQ(config.keys().size(), 3u);
  for (const KeyDescription& one : config.keys()) EXPECT_FALSE(one.meaning.empty()) << one.key;
}

RobotKeys read(const std::string& text, std::string* problems = nullptr) {
  const Properties properties = Properties::parse(text, "x.cfg");
  ConfigReader config(properties);
  const RobotKeys keys = readRobotKeys(config);
  if (problems != nullptr) {
    for (const Problem& problem : config.allProblems()) *problems += problem.text() + "\n";
  }
  return keys;
}

TEST(RobotIdentity, WithoutANameIsTheObjectsOwn) {
  const RobotKeys keys = read("");
  EXPECT_EQ(ownIdentity(keys, "Motors"), "Motors");
  EXPECT_EQ(ownIdentity(keys, "localization/component"), "localization/component");
  EXPECT_EQ(keys.viewCategory(), "robot.view");
  EXPECT_EQ(keys.tokenCategory(), "");
  EXPECT_EQ(keys.viewTokenCategory(), "");
  EXPECT_FALSE(keys.servesWeb());
}

TEST(RobotIdentity, WithANameBelongsToThatRobot) {
  const RobotKeys keys =
      read("Robot.Name = robot7\nRobot.Token = 0123456789abcdef\nRobot.ViewToken = fedcba9876543210\n");
  EXPECT_EQ(ownIdentity(keys, "Motors"), "robot7/Motors");
  EXPECT_EQ(ownIdentity(keys, "localization/component"), "robot7.component/localization");
  EXPECT_EQ(keys.viewCategory(), "robot7.view");
  EXPECT_EQ(keys.tokenCategory(), "robot7.0123456789abcdef");
  EXPECT_EQ(keys.viewTokenCategory(), "robot7.view.fedcba9876543210");
  EXPECT_TRUE(keys.servesWeb());
  EXPECT_EQ(faceName("Motors"), "Motors");
  EXPECT_EQ(faceName("localization/component"), "localization.component");
  EXPECT_EQ(faceName("cameraA/depth"), "cameraA.depth");
  EXPECT_EQ(ownIdentity(keys, "cameraA/depth"), "robot7/cameraA.depth") << "a name has no slash";
}

TEST(RobotIdentity, IsTakenOffAgain) {
  const RobotKeys keys = read("Robot.Name = robot7\n");
  for (const char* identity : {"Motors", "localization/component"})
    EXPECT_EQ(withoutRobot(keys, ownIdentity(keys, identity)), identity);
  EXPECT_EQ(withoutRobot(keys, "robot8/Motors"), "robot8/Motors");
  EXPECT_EQ(withoutRobot(read(""), "localization/component"), "localization/component");
  EXPECT_EQ(componentOfStatus("localization/component"), "localization");
  EXPECT_EQ(componentOfStatus("robot7.component/localization"), "localization");
}

TEST(RobotIdentity, WrongKeysAreReported) {
  std::string problems;
  read("Robot.Name = robot.7\nRobot.Token = short\nRobot.ViewToken = with a blank 0123456789\n", &problems);
  EXPECT_THAT(problems,
              HasSubstr("x.cfg:1: Robot.Name = robot.7 (must be 1..40 letters, digits, '-' or '_')"));
  EXPECT_THAT(problems, HasSubstr("x.cfg:2: Robot.Token = short (must be 16..100 letters"));
  EXPECT_THAT(problems, HasSubstr("x.cfg:3: Robot.ViewToken"));
  problems.clear();
  read("Robot.Token = 0123456789abcdef\nRobot.ViewToken = 0123456789abcdef\n", &problems);
  EXPECT_THAT(problems, HasSubstr("must differ from Robot.Token"));
}

TEST(ReadyLineOfTwoAdapters, KeepsWhatWebPagesUseApart) {
  const auto line = readyLine("eye", "EyeAdapter", "tcp -h 127.0.0.1 -p 1:tcp -h 127.0.0.1 -p 2",
                              "EyeWebAdapter", "ws -h 127.0.0.1 -p 3");
  EXPECT_EQ(
      line,
      "eye ready: EyeAdapter=tcp -h 127.0.0.1 -p 1:tcp -h 127.0.0.1 -p 2 EyeWebAdapter=ws -h 127.0.0.1 -p 3");
  EXPECT_EQ(readyEndpoints(line), "tcp -h 127.0.0.1 -p 1:tcp -h 127.0.0.1 -p 2");
}

}  // namespace
}  // namespace vismem
