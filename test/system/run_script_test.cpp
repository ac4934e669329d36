// scripts/run as a user calls it: help and wrong options are answered before anything is built.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

/// A copy of the script in a tree without a compiler: `scripts/build` says that it was called, and fails.
class RunScript : public testing::Test {
 protected:
  RunScript() {
    const fs::path root = VISMEM_SOURCE_DIR;
    fs::create_directories(folder_.path() / "scripts");
    fs::copy(root / "scripts/run", folder_.path() / "scripts/run");
    fs::copy(root / "scripts/run.help", folder_.path() / "scripts/run.help");
    fs::create_directories(folder_.path() / "components/simulator");
    fs::create_directories(folder_.path() / "cfg/sim");
    std::ofstream(folder_.path() / "cfg/sim/simulator.cfg") << "#\n";
    std::ofstream(folder_.path() / "cfg/sim/active_visual_memory.cfg") << "#\n";
    std::ofstream(folder_.path() / "cfg/sim/recordings.cfg") << "#\n";
    std::ofstream(folder_.path() / "scripts/build") << "#!/bin/sh\necho \"build $*\"; exit 9\n";
    fs::permissions(folder_.path() / "scripts/build", fs::perms::owner_all);
  }

  struct Answer {
    int exit_code = -1;
    std::string out;
    std::string error;
  };
  Answer run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "scripts/run");
    ChildProcess::Options options;
    options.working_directory = folder_.path();
    ChildProcess child(std::move(arguments), std::move(options));
    const auto exit = child.waitForExit(20s);
    return {exit ? *exit : -1, child.out(), child.error()};
  }

  TemporaryFolder folder_;
};

TEST_F(RunScript, AnswersHelpWithoutABuild) {
  const Answer answer = run({"--help"});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_THAT(answer.out, HasSubstr("--setup"));
}

TEST_F(RunScript, RefusesWrongOptionsWithoutABuild) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--sead", "3"}, "unknown option --sead (did you mean --seed?)"},
      {{"--seed"}, "--seed needs a value"},
      {{"--seed", "x"}, "--seed x (must be a whole number of at least 0)"},
      {{"--seconds=-1"}, "--seconds -1 (must be a number above 0)"},
      {{"--setup", "nowhere"},
       "--setup nowhere (must be a folder of cfg/ with a simulator or a replay server: sim;"},
      {{"--setup", "robot"}, "scripts/start runs other robots"},
      {{"--bag", "absent.bag"}, "--bag absent.bag: no such file"},
      {{"--bag", "/tmp,absent.bag"}, "--bag absent.bag: no such file or folder"},
  };
  for (const auto& [arguments, message] : cases) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.exit_code, 2) << message;
    EXPECT_THAT(answer.error, HasSubstr(message));
  }
}

// In Turkish the range a-z has no i.
TEST_F(RunScript, KnowsItsOptionsInAnyLanguage) {
  const std::string locale = folder_.path() / "tr_TR.UTF-8";
  ChildProcess make({"localedef", "-i", "tr_TR", "-f", "UTF-8", locale});
  if (make.waitForExit(60s) != 0) GTEST_SKIP() << "no sources of the locale tr_TR (package locales)";
  ChildProcess::Options options;
  options.working_directory = folder_.path();
  ChildProcess child(
      {"env", "LOCPATH=" + folder_.path().string(), "LC_ALL=tr_TR.UTF-8", "scripts/run", "--no-gui"},
      std::move(options));
  EXPECT_EQ(child.waitForExit(20s), 9) << child.error();
}

TEST_F(RunScript, BuildsWhatTheSetupRuns) {
  const Answer answer = run({"--setup", "sim", "--seed", "4"});
  EXPECT_EQ(answer.exit_code, 9);
  EXPECT_THAT(answer.error, HasSubstr("build release run_application simulator"));
}

TEST(RunScriptHelp, IsThatOfTheProgram) {
  ChildProcess program({std::string(VISMEM_BIN_DIR) + "/run_application", "--help"});
  ASSERT_TRUE(program.waitForExit(20s));
  std::string expected = program.out();
  const std::string name = "Usage: run_application";
  const auto at = expected.find(name);
  ASSERT_NE(at, std::string::npos);
  expected.replace(at, name.size(), "Usage: scripts/run");
  std::ifstream file(fs::path(VISMEM_SOURCE_DIR) / "scripts/run.help");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), expected)
      << "to renew it: build/release/bin/run_application --help > scripts/run.help, "
         "and write scripts/run after Usage";
}

}  // namespace
}  // namespace vismem
