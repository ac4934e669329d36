// Component tests of common/process/child_process: real shells as children.
#include "common/process/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "support/build_paths.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

ChildProcess shell(const std::string& script) {
  return ChildProcess({"/bin/sh", "-c", script});
}

TEST(ChildProcess, GivesExitCodeAndBothStreams) {
  const auto child = shell("echo good; echo bad >&2; printf unfinished; exit 3");
  EXPECT_EQ(child.waitForExit(10s), 3);
  EXPECT_EQ(child.out(), "good\nunfinished\n");
  EXPECT_EQ(child.error(), "bad\n");
  EXPECT_FALSE(child.running());
}

TEST(ChildProcess, WaitsForALineThatContainsTheText) {
  auto child = shell("echo starting; echo thing ready: port 7; exec sleep 100");
  EXPECT_EQ(child.waitForLine("ready", 10s), "thing ready: port 7");
  EXPECT_EQ(child.waitForLine("ready", 10ms, child.lineCount()), std::nullopt) << "only new lines count";
  EXPECT_TRUE(child.running());
}

TEST(ChildProcess, StopsWaitingForALineWhenTheChildEnds) {
  const auto begin = std::chrono::steady_clock::now();
  const auto child = shell("echo nothing to see");
  EXPECT_EQ(child.waitForLine("ready", 30s), std::nullopt);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
}

TEST(ChildProcess, HasReadTheErrorsThatWereWrittenBeforeALineOfTheOutput) {
  for (int trial = 0; trial < 100; ++trial) {
    const auto child = shell("yes error | head -n 5000 >&2; echo last >&2; echo ready; exec sleep 100");
    ASSERT_TRUE(child.waitForLine("ready", 10s));
    ASSERT_THAT(child.error(), HasSubstr("last\n")) << "trial " << trial;
  }
}

TEST(ChildProcess, StopAsksWithSigtermFirst) {
  auto child = shell("trap 'echo bye; exit 0' TERM; echo ready; while :; do sleep 0.01; done");
  ASSERT_TRUE(child.waitForLine("ready", 10s));
  EXPECT_EQ(child.stop(10s), 0);
  EXPECT_EQ(child.out(), "ready\nbye\n");
  EXPECT_FALSE(child.signal(SIGTERM)) << "the kernel may have reused the pid";
}

TEST(ChildProcess, StopKillsAChildThatDoesNotListen) {
  auto child = shell("trap '' TERM; echo ready; while :; do sleep 0.01; done");
  ASSERT_TRUE(child.waitForLine("ready", 10s));
  EXPECT_EQ(child.stop(50ms), 128 + SIGKILL);
}

TEST(ChildProcess, DestructorKillsEvenAFrozenChild) {
  pid_t pid = 0;
  {
    auto child = shell("echo ready; exec sleep 100");
    ASSERT_TRUE(child.waitForLine("ready", 10s));
    pid = child.pid();
    ASSERT_TRUE(child.signal(SIGSTOP));
  }
  EXPECT_EQ(kill(pid, 0), -1) << "reaped, so the number is free";
}

TEST(ChildProcess, DiesWithItsOwner) {
  // The middle process has a child of its own and is killed, so no destructor runs.
  auto middle = ChildProcess({VISMEM_BIN_DIR "/child_owner"});
  const auto line = middle.waitForLine("grandchild ", 10s);
  ASSERT_TRUE(line);
  const pid_t grandchild = std::stoi(line->substr(line->find(' ') + 1));
  ASSERT_TRUE(middle.signal(SIGKILL));
  ASSERT_EQ(middle.waitForExit(10s), 128 + SIGKILL);
  const auto gone = [grandchild] {
    // Without an init that reaps it, a dead orphan stays as a zombie.
    auto state =
        ChildProcess({"/bin/sh", "-c", "grep State: /proc/" + std::to_string(grandchild) + "/status"});
    state.waitForExit(10s);
    return state.out().empty() || state.out().find("Z (zombie)") != std::string::npos;
  };
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (!gone() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_TRUE(gone());
}

TEST(ChildProcess, SaysWhyAProgramCannotStart) {
  try {
    ChildProcess child({"/no/such/program"});
    FAIL() << "started";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "cannot start /no/such/program: No such file or directory");
  }
}

TEST(ChildProcess, PassesEnvironmentFolderAndLines) {
  std::vector<std::string> seen;
  ChildProcess::Options options;
  options.environment = {{"COLOUR", "green"}};
  options.working_directory = "/";
  options.on_line = [&](const ChildProcess::Line& line) { seen.push_back(line.text); };
  options.kept_lines = 1;
  const ChildProcess child({"/bin/sh", "-c", "echo $COLOUR; pwd"}, options);
  EXPECT_EQ(child.waitForExit(10s), 0);
  EXPECT_THAT(seen, testing::ElementsAre("green", "/"));
  EXPECT_EQ(child.out(), "/\n") << "only the last line is kept";
  EXPECT_EQ(child.lineCount(), 2u);
}

TEST(ChildProcess, StartsWithAnEmptySignalMask) {
  sigset_t terminate;
  sigset_t before;
  sigemptyset(&terminate);
  sigaddset(&terminate, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &terminate, &before);
  auto child = shell("echo ready; exec sleep 100");
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ASSERT_TRUE(child.waitForLine("ready", 10s));
  EXPECT_EQ(child.stop(10s), 128 + SIGTERM);
}

}  // namespace
}  // namespace vismem
