/// @file The whole application as its user starts it: real processes over Ice on loopback.
#include <Ice/Ice.h>
#include <avm/simulation.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/free_ports.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Processes whose command line holds one of the texts.
std::vector<pid_t> processesWith(const std::vector<std::string>& texts) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream in(entry.path() / "cmdline", std::ios::binary);
    std::ostringstream line;
    line << in.rdbuf();
    const auto holds = [&](const std::string& text) { return line.str().find(text) != std::string::npos; };
    if (std::any_of(texts.begin(), texts.end(), holds)) found.push_back(std::stoi(name));
  }
  return found;
}

class RunApplication : public testing::Test {
 protected:
  void SetUp() override {
    out_ = fs::temp_directory_path() / ("run_application_test." + std::to_string(getpid()));
    fs::remove_all(out_);
  }
  void TearDown() override { fs::remove_all(out_); }

  std::unique_ptr<ChildProcess> start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), std::string(VISMEM_BIN_DIR) + "/run_application");
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    return std::make_unique<ChildProcess>(std::move(arguments), std::move(options));
  }
  std::unique_ptr<ChildProcess> startSimulation(std::vector<std::string> arguments = {}) {
    offset_ = freePortOffset();
    for (const std::string& argument :
         {std::string("--out"), out_.string(), std::string("--port-offset"), std::to_string(offset_)}) {
      arguments.push_back(argument);
    }
    return start(arguments);
  }
  /// The components of a run carry its shifted ports on their command lines.
  std::vector<pid_t> components() const {
    return processesWith({"-p " + std::to_string(9970 + offset_), "-p " + std::to_string(9999 + offset_)});
  }
  bool noneLeftWithin(std::chrono::seconds patience) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!components().empty()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(20ms);
    }
    return true;
  }
  static nlohmann::json lastLine(const ChildProcess& run) {
    std::istringstream out(run.out());
    std::string last;
    for (std::string line; std::getline(out, line);) last = line;
    return nlohmann::json::parse(last, nullptr, false);
  }
  void expectFigures() const {
    for (const char* name : {"top_view.png", "error.png", "last_image.png"}) {
      std::error_code error;
      EXPECT_GT(fs::file_size(out_ / name, error), 10'000u) << name;
    }
    for (const char* name :
         {"trajectory.tum", "odometry.tum", "truth.tum", "memory.csv", "races.csv", "result.json"}) {
      std::error_code error;
      EXPECT_GT(fs::file_size(out_ / name, error), 50u) << name;
    }
  }

  fs::path out_;
  int offset_ = 0;
};

TEST_F(RunApplication, FindsTheSimulatedRobotAndReportsIt) {
  const auto run = startSimulation({"--seconds", "18", "--seed", "1"});
  ASSERT_EQ(run->waitForExit(150s), 0) << run->error();
  const nlohmann::json result = lastLine(*run);
  ASSERT_TRUE(result.is_object()) << run->out();
  for (const char* key : {"position_error_m", "heading_error_deg", "settled_after_s", "recovered",
                          "memory_segments", "memory_hz", "camera_hz"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  EXPECT_GE(result["seconds"].get<double>(), 17.9);
  EXPECT_GT(result["distance_m"].get<double>(), 2.0) << "the operator drives";
  EXPECT_GT(result["memory_segments"].get<int>(), 0);
  // Half of the real time's rates: the machine may be busy with other tests.
  EXPECT_GT(result["camera_hz"].get<double>(), 15.0);
  EXPECT_GT(result["memory_hz"].get<double>(), 5.0);
  ASSERT_TRUE(result["settled_after_s"].is_number()) << result;
  EXPECT_LT(result["position_error_m"].get<double>(), 0.5);
  expectFigures();
  EXPECT_THAT(run->error(), testing::HasSubstr("reliability")) << "the live status";
  EXPECT_TRUE(noneLeftWithin(5s));
}

TEST_F(RunApplication, APausedSimulationIsNoFailureAndAResetOneGoesOn) {
  const auto run = startSimulation({"--seconds", "6"});
  ASSERT_TRUE(run->waitForLine("reliability", 60s)) << run->error();
  const Ice::CommunicatorHolder client{Ice::initialize()};
  const auto simulation = Ice::uncheckedCast<avm::SimulationPrx>(
      client->stringToProxy("Simulation:tcp -h 127.0.0.1 -p " + std::to_string(9972 + offset_)));
  simulation->setPaused(true);
  EXPECT_TRUE(run->waitForLine(" s, paused |", 10s)) << run->error();
  EXPECT_TRUE(run->waitForLine("| camera  0.0 Hz | memory  0.0 Hz", 10s)) << run->error();
  simulation->reset(2);
  simulation->setPaused(false);
  ASSERT_EQ(run->waitForExit(60s), 0) << run->error();
  EXPECT_GE(lastLine(*run)["seconds"].get<double>(), 5.9);
}

// As on a full disk: the recorder can write no further, all else goes on.
TEST_F(RunApplication, ARecordingThatFailsIsNamedAtOnceAndInTheEnd) {
  offset_ = freePortOffset();
  const std::string program = std::string(VISMEM_BIN_DIR) + "/run_application";
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  ChildProcess run({"bash", "-c", "ulimit -f 3000; exec \"$@\"", "limited", program, "--record", "--no-gui",
                    "--seconds", "6", "--out", out_.string(), "--port-offset", std::to_string(offset_)},
                   std::move(options));
  EXPECT_TRUE(run.waitForLine("s | recording failed: ", 60s)) << run.error();
  ASSERT_EQ(run.waitForExit(60s), 1) << run.error();
  EXPECT_THAT(run.error(), testing::HasSubstr("run_application: recording failed: "));
  EXPECT_TRUE(lastLine(run).is_object());
  expectFigures();
}

TEST_F(RunApplication, CtrlCEndsWithFiguresAndExitCodeZero) {
  const auto run = startSimulation();
  ASSERT_TRUE(run->waitForLine("reliability", 60s)) << run->error();
  run->signal(SIGINT);
  ASSERT_EQ(run->waitForExit(30s), 0) << run->error();
  EXPECT_TRUE(lastLine(*run).is_object());
  expectFigures();
  EXPECT_TRUE(noneLeftWithin(5s));
}

TEST_F(RunApplication, ADeadComponentEndsTheRunWithItsNameAndTheFigures) {
  const auto run = startSimulation();
  ASSERT_TRUE(run->waitForLine("reliability", 60s)) << run->error();
  const auto all = components();
  ASSERT_EQ(all.size(), 3u);
  const auto localization = processesWith({std::string(VISMEM_BIN_DIR) + "/localization"});
  pid_t victim = 0;
  for (const pid_t pid : all) {
    if (std::find(localization.begin(), localization.end(), pid) != localization.end()) victim = pid;
  }
  ASSERT_NE(victim, 0);
  kill(victim, SIGKILL);
  EXPECT_EQ(run->waitForExit(20s), 1);
  EXPECT_THAT(run->error(), testing::HasSubstr("localization was killed by signal 9 (Killed)"));
  EXPECT_TRUE(lastLine(*run).is_object());
  expectFigures();
  EXPECT_TRUE(noneLeftWithin(5s));
}

TEST_F(RunApplication, KilledItTakesItsComponentsAlong) {
  const auto run = startSimulation();
  ASSERT_TRUE(run->waitForLine("reliability", 60s)) << run->error();
  EXPECT_FALSE(components().empty());
  run->signal(SIGKILL);
  EXPECT_TRUE(noneLeftWithin(10s));
}

TEST_F(RunApplication, APortInUseIsOneClearMessage) {
  const int offset = freePortOffset();
  const Listener taken(9999 + offset);
  ASSERT_TRUE(taken.good());
  const auto run = start({"--out", out_.string(), "--port-offset", std::to_string(offset)});
  ASSERT_EQ(run->waitForExit(20s), 1) << run->error();
  EXPECT_THAT(run->error(), testing::AllOf(testing::HasSubstr("simulator ended"),
                                           testing::HasSubstr("Address already in use")));
  EXPECT_FALSE(fs::exists(out_)) << "an empty folder of results is removed";
}

TEST_F(RunApplication, CtrlCBeforeTheComponentsAreReadyLeavesNothing) {
  const auto run = startSimulation();
  ASSERT_TRUE(run->waitForLine("results in", 20s)) << run->error();
  run->signal(SIGINT);
  EXPECT_EQ(run->waitForExit(20s), 0) << run->error();
  EXPECT_THAT(run->error(), testing::HasSubstr("stopped before the components were ready"));
  EXPECT_EQ(run->out(), "") << "no JSON of a run that was none";
  EXPECT_FALSE(fs::exists(out_));
  EXPECT_TRUE(noneLeftWithin(5s));
}

TEST_F(RunApplication, BadInputIsOneClearMessage) {
  fs::create_directories(out_);
  const std::string broken_map = (out_ / "broken.csv").string();
  std::ofstream(broken_map) << "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n1,2,three,4,5,6,line\n";
  const std::string map = VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--setup", "mars"}, "with a simulator or a replay server: humanoid, nao, replay, sim"},
      {{"--seconds", "soon"}, "--seconds soon (must be a number above 0)"},
      {{"--seconds", "-3"}, "--seconds -3 (must be a number above 0)"},
      {{"--seed", "x"}, "--seed x (must be a whole number"},
      {{"--port-offset", "70000"}, "--port-offset 70000 (must be a whole number 0..50000)"},
      {{"--world", "absent.world"}, "--world absent.world: no such file"},
      {{"--map", "absent.csv"}, "--map absent.csv: no such file"},
      {{"--map", broken_map}, "broken.csv:2:"},
      {{"--setup", "replay", "--map", map}, "--setup replay needs --bag FILE"},
      {{"--setup", "replay", "--bag", "absent.bag", "--map", map}, "--bag absent.bag: no such file"},
      {{"--setup", "replay", "--bag", map, "--map", map, "--topics", "picture=/a"},
       "--topics \"picture=/a\""},
      {{"--setup", "replay", "--bag", map, "--map", map, "--palette", "absent"},
       "--palette absent: no such file"},
      {{"--bogus"}, "--bogus"},
      {{"--out", "/proc/nowhere"}, "--out /proc/nowhere: cannot make this folder"},
  };
  for (auto [arguments, message] : cases) {
    if (arguments[0] != "--out") arguments.insert(arguments.end(), {"--out", (out_ / "result").string()});
    const auto run = start(arguments);
    ASSERT_EQ(run->waitForExit(10s), 2) << message << "\n" << run->error();
    EXPECT_THAT(run->error(), testing::HasSubstr(message));
    EXPECT_EQ(run->out(), "") << "no JSON of a run that was none";
  }
}

TEST_F(RunApplication, ABrokenBagEndsWithItsReadersMessage) {
  fs::create_directories(out_);
  const std::string bag = (out_ / "broken.bag").string();
  std::ofstream(bag) << "this is no bag\n";
  const auto run =
      start({"--setup", "replay", "--bag", bag, "--map", VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv", "--out",
             (out_ / "result").string(), "--port-offset", std::to_string(freePortOffset())});
  ASSERT_EQ(run->waitForExit(20s), 1) << run->error();
  EXPECT_THAT(run->error(),
              testing::AllOf(testing::HasSubstr("replay_server ended"), testing::HasSubstr("broken.bag")));
}

}  // namespace
}  // namespace vismem
