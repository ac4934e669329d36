// scripts/start, scripts/status and scripts/stop as a user calls them, at ports and in a folder of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/free_ports.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class StartStop : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path build = fs::path(VISMEM_BIN_DIR).parent_path();
    preset_ = build.filename();
    if (build != root() / "build" / preset_)
      GTEST_SKIP() << "not built by a preset: scripts look in build/PRESET/";
    offset_ = freePortOffset();
    setup_ = "sim+" + std::to_string(offset_);
  }
  void TearDown() override {
    if (offset_ == 0) return;
    run("stop", {setup_});
    fs::remove_all(root() / "out" / setup_);
  }

  static fs::path root() { return VISMEM_SOURCE_DIR; }
  static std::unique_ptr<ChildProcess> run(const std::string& script, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "scripts/" + script);
    ChildProcess::Options options;
    options.working_directory = root();
    auto child = std::make_unique<ChildProcess>(std::move(arguments), std::move(options));
    child->waitForExit(60s);
    return child;
  }
  std::unique_ptr<ChildProcess> start(std::vector<std::string> more) {
    std::vector<std::string> arguments{"sim",   "--no-build",    "--preset",
                                       preset_, "--port-offset", std::to_string(offset_)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run("start", arguments);
  }
  std::map<std::string, pid_t> processes() const {
    std::map<std::string, pid_t> found;
    std::ifstream list(root() / "out" / setup_ / "pids");
    pid_t pid = 0;
    for (std::string name; list >> pid >> name;) found[name] = pid;
    return found;
  }
  /// Asks the built tool itself: scripts/status is for the release build.
  std::unique_ptr<ChildProcess> status() const {
    ChildProcess::Options options;
    options.working_directory = root();
    auto child = std::make_unique<ChildProcess>(
        std::vector<std::string>{std::string(VISMEM_BIN_DIR) + "/show_status", setup_}, std::move(options));
    child->waitForExit(kPatience);
    return child;
  }
  bool wholeWithin(std::chrono::seconds patience) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (status()->exitCode() == 0) return true;
    }
    return false;
  }

  std::string preset_;
  std::string setup_;
  int offset_ = 0;
};

TEST_F(StartStop, ASetupInTheBackgroundOneComponentReplacedAndItsEnd) {
  const auto started = start({"--Localization.Seed=7"});
  ASSERT_EQ(started->exitCode(), 0) << started->error();
  for (const char* name : {"simulator", "active_visual_memory", "localization", "gui_server"})
    EXPECT_THAT(started->out(), HasSubstr(std::string(name) + " ready: "));
  EXPECT_THAT(started->out(),
              testing::StartsWith("page http://127.0.0.1:" + std::to_string(8770 + offset_) + "/\n"));
  EXPECT_THAT(started->out(), HasSubstr("-p " + std::to_string(9971 + offset_)));
  EXPECT_TRUE(wholeWithin(20s)) << status()->out();
  ASSERT_EQ(processes().size(), 4u);

  const auto again = start({});
  EXPECT_EQ(again->exitCode(), 1);
  EXPECT_THAT(again->error(), HasSubstr("of " + setup_ + " runs already (process "));

  const auto victim = processes()["localization"];
  kill(victim, SIGKILL);
  EXPECT_EQ(status()->exitCode(), 1);
  // As status and stop name it; with the key that it had.
  const auto replaced = run("start", {setup_, "localization", "--no-build", "--preset", preset_});
  ASSERT_EQ(replaced->exitCode(), 0) << replaced->error();
  const auto shown = run("status", {setup_, "--configuration", "localization"});
  EXPECT_THAT(shown->out(), HasSubstr("Localization.Seed = 7")) << shown->error();
  EXPECT_THAT(replaced->out(), AllOf(HasSubstr("localization ready: "), Not(HasSubstr("simulator"))));
  EXPECT_TRUE(wholeWithin(20s)) << status()->out();
  EXPECT_EQ(processes().size(), 4u);

  const auto stopped = run("stop", {setup_});
  EXPECT_EQ(stopped->exitCode(), 0);
  for (const char* name : {"simulator", "active_visual_memory", "localization", "gui_server"})
    EXPECT_THAT(stopped->out(), HasSubstr(std::string("stop: ") + name + " ended"));
  EXPECT_TRUE(processes().empty());
}

TEST_F(StartStop, AFrozenComponentIsStoppedToo) {
  ASSERT_EQ(start({"localization"})->exitCode(), 0);
  kill(processes()["localization"], SIGSTOP);
  const auto stopped = run("stop", {setup_, "localization"});
  EXPECT_THAT(stopped->out(), HasSubstr("stop: localization ended"));
}

TEST_F(StartStop, PortsOfAnotherSetupAreNamedWithTheWayOut) {
  ASSERT_EQ(start({"localization"})->exitCode(), 0);
  const std::string offset = std::to_string(offset_);
  const auto other =
      run("start", {"humanoid", "localization", "--no-build", "--preset", preset_, "--port-offset", offset});
  fs::remove_all(root() / "out" / ("humanoid+" + offset));
  EXPECT_EQ(other->exitCode(), 1);
  EXPECT_THAT(other->error(), HasSubstr("another setup may have these ports: --port-offset 100"));
}

TEST_F(StartStop, WhatCannotStartIsNamedAndLeavesNothingBehind) {
  const auto bad = start({"--Localization.Seed=x"});
  EXPECT_EQ(bad->exitCode(), 1);
  EXPECT_THAT(bad->error(),
              AllOf(HasSubstr("localization did not become ready"), HasSubstr("Localization.Seed = x")));
  EXPECT_TRUE(processes().empty());
  EXPECT_EQ(start({"--Camera.Seed=x"})->exitCode(), 2);
  EXPECT_EQ(start({"camera"})->exitCode(), 2);
  EXPECT_EQ(run("start", {"mars"})->exitCode(), 2);
  EXPECT_THAT(run("start", {"mars"})->error(), HasSubstr("start: setup mars (must be one of files humanoid"));
  EXPECT_THAT(start({"--recrod"})->error(),
              HasSubstr("unknown option --recrod (must be --record, --port-offset N"));
  EXPECT_EQ(run("start", {"sim", "--port-offset", "x"})->exitCode(), 2);
}

}  // namespace
}  // namespace vismem
