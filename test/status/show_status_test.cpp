// show_status against real processes: running, frozen and absent ones; exit codes; speed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/process/ready_line.h"
#include "support/build_paths.h"
#include "support/component_process.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ShowStatus : public testing::Test {
 protected:
  ShowStatus() : root_(fs::path(testing::TempDir()) / ("show_status." + std::to_string(getpid()))) {
    fs::create_directories(root_ / "cfg/lab");
    fs::create_directories(root_ / "out/lab");
    std::ofstream(root_ / "cfg/lab/probe_component.cfg") << "Probe.Size = 3\n";
  }
  ~ShowStatus() override { fs::remove_all(root_); }

  /// The files of scripts/start.
  void record(const std::vector<const ComponentProcess*>& probes) {
    std::ofstream list(root_ / "out/lab/pids");
    std::ofstream out(root_ / "out/lab/probe_component.out");
    for (const auto* probe : probes) {
      list << probe->pid() << " probe_component\n";
      out << probe->readyLine().value_or("") << "\n";
    }
  }
  std::unique_ptr<ChildProcess> status(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), std::string(VISMEM_BIN_DIR) + "/show_status");
    ChildProcess::Options options;
    options.working_directory = root_;
    auto run = std::make_unique<ChildProcess>(std::move(arguments), std::move(options));
    run->waitForExit(kPatience);
    return run;
  }

  const fs::path root_;
};

TEST_F(ShowStatus, ARunningComponentWithItsConfiguration) {
  ComponentProcess probe("probe_component", {"--Probe.Size=5"});
  record({&probe});
  const auto table = status({});
  EXPECT_EQ(table->exitCode(), 0) << table->error();
  EXPECT_THAT(table->out(), HasSubstr("lab    probe_component  running "));
  const auto json = status({"lab", "--json"});
  const auto parsed = nlohmann::json::parse(json->out());
  EXPECT_EQ(parsed["whole"], true);
  EXPECT_EQ(parsed["components"][0]["state"], "running");
  const auto configuration = status({"--configuration", "probe_component"});
  EXPECT_EQ(configuration->exitCode(), 0);
  EXPECT_THAT(configuration->out(), AllOf(HasSubstr("Probe.Size = 5\n"), HasSubstr("Probe.Work = serve\n")));
}

TEST_F(ShowStatus, ASetupWithoutItsPageIsWholeUnlessThePageWasStarted) {
  ComponentProcess probe("probe_component", {});
  const auto endpoints = readyEndpoints(probe.readyLine().value_or("")).value_or("");
  std::ofstream(root_ / "cfg/lab/probe_component.cfg") << "ProbeComponent.Endpoints = " << endpoints << "\n";
  std::ofstream(root_ / "cfg/lab/gui_server.cfg") << "GuiServer.Endpoints = tcp -h 127.0.0.1 -p 1\n";
  const auto without = status({"lab"});
  EXPECT_EQ(without->exitCode(), 0) << without->out() << without->error();
  EXPECT_THAT(without->out(), AllOf(HasSubstr("probe_component  running"), Not(HasSubstr("gui_server"))));
  record({&probe});
  std::ofstream(root_ / "out/lab/pids", std::ios::app) << "1 gui_server\n";
  std::ofstream(root_ / "out/lab/gui_server.out")
      << "gui_server ready: GuiServerAdapter=tcp -h 127.0.0.1 -p 1\n";
  const auto died = status({"lab"});
  EXPECT_EQ(died->exitCode(), 1);
  EXPECT_THAT(died->out(), HasSubstr("gui_server       absent"));
}

TEST_F(ShowStatus, AFrozenAndAnAbsentComponentDelayItByOneTimeoutAtMost) {
  ComponentProcess probe("probe_component", {});
  record({&probe});
  ASSERT_TRUE(probe.signal(SIGSTOP));
  const auto begin = std::chrono::steady_clock::now();
  const auto silent = status({"lab", "--timeout", "0.3"});
  const auto spent = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(silent->exitCode(), 1);
  EXPECT_THAT(silent->out(), HasSubstr("silent               no answer in time"));
  EXPECT_LT(spent, 5s) << "bounded; 0.4 s on a machine with nothing else to do";
  probe.signal(SIGKILL);
  probe.waitForExit(kPatience);
  const auto absent = status({"lab"});
  EXPECT_EQ(absent->exitCode(), 1);
  EXPECT_THAT(absent->out(), HasSubstr("absent               connection refused"));
}

TEST_F(ShowStatus, WatchesUntilAStopRequest) {
  ComponentProcess probe("probe_component", {});
  record({&probe});
  ChildProcess::Options options;
  options.working_directory = root_;
  ChildProcess watch({std::string(VISMEM_BIN_DIR) + "/show_status", "--watch", "--json", "--interval", "0.1"},
                     options);
  ASSERT_TRUE(watch.waitForLine("\"running\"", kPatience));
  const auto lines = watch.lineCount();
  EXPECT_TRUE(watch.waitForLine("\"running\"", kPatience, lines)) << "again";
  watch.signal(SIGINT);
  EXPECT_EQ(watch.waitForExit(kPatience), 0);
}

TEST_F(ShowStatus, UsageErrorsEndWithCode2) {
  EXPECT_EQ(status({"--bogus"})->exitCode(), 2);
  EXPECT_EQ(status({"--timeout", "soon"})->exitCode(), 2);
  const auto mars = status({"mars"});
  EXPECT_EQ(mars->exitCode(), 2);
  EXPECT_THAT(mars->error(), HasSubstr("setup mars (must be a folder of cfg/"));
  EXPECT_EQ(status({"--help"})->exitCode(), 0);
  EXPECT_EQ(status({"--configuration", "localization"})->exitCode(), 1) << "no such component runs";
}

}  // namespace
}  // namespace vismem
