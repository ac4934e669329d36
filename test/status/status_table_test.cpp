// The table and the JSON of scripts/status, and how it finds the components.
#include "status/core/status_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "common/config/config_error.h"
#include "status/app/setup_search.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ComponentRow degradedMemory() {
  StatusReport report;
  report.name = "active_visual_memory";
  report.version = "0.1.0";
  report.state = RunState::kDegraded;
  report.reason = "Camera is lost (connection refused)";
  report.uptime_s = 83.4;
  report.peers = {{"Camera", "cameraA:tcp -p 9999", PeerState::Link::kLost, "connection refused", 2},
                  {"Odometry", "Encoders:tcp -p 9997", PeerState::Link::kConnected, "", 0}};
  report.rates = {{"frames", 29.96, 1234}};
  report.latencies = {{"iteration", {1000, 0.0013, 0.0025, 0.004, 0.0071}}};
  report.gauges = {{"camera tilt pitch error", -0.4567, 0.031, "deg"}, {"head roll", -0.002, 0.5, "deg"}};
  for (int i = 1; i <= 5; ++i) report.errors.push_back({i * 1'000'000, "error " + std::to_string(i)});
  return {"sim", "active_visual_memory", "tcp -p 9970", report, "", false};
}

TEST(StatusTable, ShowsStatesReasonsAndWhatIsBelow) {
  const std::vector<ComponentRow> rows{
      degradedMemory(),
      {"sim", "localization", "tcp -p 9971", std::nullopt, "connection refused", true},
      {"sim", "simulator", "tcp -p 9999", std::nullopt, "no answer in time", false}};
  const std::string table = statusTable(rows, false);
  EXPECT_THAT(
      table,
      HasSubstr("SETUP  COMPONENT             STATE     UP         REASON\n"
                "sim    active_visual_memory  degraded  1:23       Camera is lost (connection refused)\n"));
  EXPECT_THAT(table, HasSubstr("    peers        Camera         away, reconnections: 2   cameraA:tcp -p 9999 "
                               "(connection refused)\n"
                               "                 Odometry       connected   Encoders:tcp -p 9997\n"));
  EXPECT_THAT(table, HasSubstr("    rates        frames            30.0 Hz       1234 in all\n"));
  EXPECT_THAT(table, HasSubstr("    latencies    iteration      p50 1.3  p95 2.5  p99 4.0  max 7.1 ms\n"));
  EXPECT_THAT(table, HasSubstr("    estimates    camera tilt pitch error -0.46 +- 0.03 deg\n"
                               "                 head roll               0.00 +- 0.50 deg\n"));
  EXPECT_THAT(table, AllOf(HasSubstr("error 5\n"), HasSubstr("error 3\n"), Not(HasSubstr("error 2\n"))));
  EXPECT_THAT(table, HasSubstr("sim    localization          absent               connection refused\n"));
  EXPECT_THAT(table, HasSubstr("sim    simulator             silent               no answer in time\n"));
  EXPECT_THAT(table, Not(HasSubstr("\033"))) << "no escape sequences in files";
  EXPECT_THAT(statusTable(rows, true),
              AllOf(HasSubstr("\033[33mdegraded\033[0m"), HasSubstr("\033[31mabsent  \033[0m")));
}

TEST(StatusTable, IsWholeOnlyWhenAllAreRunning) {
  auto row = degradedMemory();
  EXPECT_FALSE(isWhole({row}));
  row.report->state = RunState::kRunning;
  EXPECT_TRUE(isWhole({row}));
  EXPECT_FALSE(isWhole({row, {"sim", "simulator", "", std::nullopt, "no answer in time", false}}));
  EXPECT_FALSE(isWhole({})) << "nothing runs";
}

TEST(StatusTable, JsonHasEverything) {
  const auto json =
      statusJson({degradedMemory(), {"sim", "simulator", "tcp -p 9999", std::nullopt, "refused", true}});
  EXPECT_EQ(json["whole"], false);
  const auto& memory = json["components"][0];
  EXPECT_EQ(memory["state"], "degraded");
  EXPECT_EQ(memory["peers"][0]["connected"], false);
  EXPECT_EQ(memory["peers"][0]["reconnections"], 2);
  EXPECT_EQ(memory["rates"][0]["total"], 1234);
  EXPECT_NEAR(memory["latencies"][0]["p95_ms"].get<double>(), 2.5, 1e-9);
  EXPECT_EQ(memory["gauges"][0]["name"], "camera tilt pitch error");
  EXPECT_EQ(memory["gauges"][0]["value"], -0.4567);
  EXPECT_EQ(memory["gauges"][0]["sigma"], 0.031);
  EXPECT_EQ(memory["gauges"][0]["unit"], "deg");
  EXPECT_EQ(memory["errors"].size(), 5u);
  EXPECT_EQ(json["components"][1]["state"], "absent");
  EXPECT_EQ(json["components"][1]["reason"], "refused");
  EXPECT_FALSE(json["components"][1].contains("peers"));
}

class SetupSearch : public testing::Test {
 protected:
  SetupSearch() : root_(fs::path(testing::TempDir()) / ("setup_search." + std::to_string(getpid()))) {
    write("cfg/sim/simulator.cfg", "Simulator.Endpoints = tcp -h 127.0.0.1 -p 9999:ws -p 11000  # comment\n");
    write("cfg/sim/localization.cfg", "Localization.Seed = 1\n");
    write("cfg/sim/recordings.cfg", "Recording.nao.FirstImage = 1\n");
  }
  ~SetupSearch() override { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  const fs::path root_;
};

TEST_F(SetupSearch, ReadsTheConfigurationOfASetupThatWasNotStarted) {
  const auto rows = rowsOfSetup(root_, root_ / "cfg", "sim", 100);
  ASSERT_EQ(rows.size(), 2u) << "recordings.cfg is no component's";
  EXPECT_EQ(rows[0].name, "localization");
  EXPECT_THAT(rows[0].failure, HasSubstr("names no endpoints"));
  EXPECT_EQ(rows[1].endpoints, "tcp -h 127.0.0.1 -p 10099:ws -p 11100");
  EXPECT_EQ(statusProxyOf(rows[1]), "simulator/component:tcp -h 127.0.0.1 -p 10099");
  EXPECT_THAT(startedSetups(root_), IsEmpty());
}

TEST_F(SetupSearch, AsksARobotWithANameUnderItsName) {
  write("cfg/sim/simulator.cfg", "Simulator.Endpoints = tcp -h 127.0.0.1 -p 9999\nRobot.Name = robot7\n");
  EXPECT_EQ(statusProxyOf(rowsOfSetup(root_, root_ / "cfg", "sim", 0)[1]),
            "robot7.component/simulator:tcp -h 127.0.0.1 -p 9999");
  write("out/sim+5/pids", "123 simulator\n");
  write("out/sim+5/simulator.out", "simulator ready: SimulatorAdapter=tcp -h 127.0.0.1 -p 2\n");
  EXPECT_EQ(statusProxyOf(rowsOfSetup(root_, root_ / "cfg", "sim+5", 0)[0]),
            "robot7.component/simulator:tcp -h 127.0.0.1 -p 2");
}

TEST_F(SetupSearch, ReadsWhereStartedComponentsReallyServe) {
  write("out/sim+5/pids", "123 simulator\n124 localization\n");
  write("out/sim+5/simulator.out",
        "simulator ready: SimulatorAdapter=tcp -h 127.0.0.1 -p 1\n"
        "simulator ready: SimulatorAdapter=tcp -h 127.0.0.1 -p 2:ws -p 3\n");
  write("out/sim+5/localization.out", "");
  write("out/20260101-101010/trajectory.tum", "");
  EXPECT_THAT(startedSetups(root_), ElementsAre("sim+5"));
  const auto rows = rowsOfSetup(root_, root_ / "cfg", "sim+5", 0);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(statusProxyOf(rows[0]), "simulator/component:tcp -h 127.0.0.1 -p 2") << "the last start counts";
  EXPECT_EQ(rows[1].failure, "it has not become ready");
}

TEST_F(SetupSearch, NamesWhatIsNoSetup) {
  EXPECT_THROW(
      {
        try {
          rowsOfSetup(root_, root_ / "cfg", "mars", 0);
        } catch (const ConfigError& error) {
          EXPECT_THAT(error.what(),
                      HasSubstr("setup mars (must be a folder of " + (root_ / "cfg").string() + "/"));
          throw;
        }
      },
      ConfigError);
}

}  // namespace
}  // namespace vismem
