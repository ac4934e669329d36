#include <gmock/gmock.h>

#include <sstream>

#include "experiments/app/launcher.h"
#include "experiments/app/run_inputs.h"
#include "experiments/app/status_line.h"

namespace vismem {
namespace {

RunOptions simulation() {
  RunOptions options;
  options.root = VISMEM_SOURCE_DIR;
  options.world = options.root / "cfg/worlds/corridor.world";
  options.route = options.root / "cfg/worlds/corridor.route";
  options.map = options.root / "cfg/maps/corridor.csv";
  return options;
}

TEST(Commands, NameTheConfigurationAndWhatTheRunSets) {
  RunOptions options = simulation();
  options.seed = 7;
  options.port_offset = 1000;
  const auto commands = commandsOf(options);
  ASSERT_EQ(commands.size(), 3u);
  EXPECT_EQ(commands[0].name, "simulator");
  const std::vector<std::string>& simulator = commands[0].arguments;
  EXPECT_THAT(simulator, testing::Contains(testing::EndsWith("cfg/sim/simulator.cfg")));
  EXPECT_THAT(simulator, testing::Contains("--Simulator.Seed=7"));
  EXPECT_THAT(simulator, testing::Contains(testing::HasSubstr("Endpoints=tcp -h 127.0.0.1 -p 10999")));
  EXPECT_THAT(simulator, testing::Contains(testing::StartsWith("--Simulator.Start.Position_m=")));
  EXPECT_EQ(commands[1].name, "active_visual_memory");
  EXPECT_THAT(commands[1].arguments,
              testing::Contains(
                  testing::StrEq("--ActiveVisualMemory.Camera.Proxy=cameraA:tcp -h 127.0.0.1 -p 10999")));
  EXPECT_EQ(commands[2].name, "localization");
  EXPECT_THAT(commands[2].arguments, testing::Contains(testing::StrEq("--Localization.Seed=7")));
}

TEST(RunInputs, TheShippedRouteMapAndRecordingsLoad) {
  EXPECT_NEAR(loadRoute(simulation().route).length(), 26.0, 1e-9);
  const RunMap map = loadRunMap(simulation().map, simulation().root / "cfg/maps/corridor.palette");
  EXPECT_GE(map.edges.segments.size(), map.map.segments.size());
  RunOptions replay = simulation();
  replay.setup = Setup::kReplay;
  replay.bag = "anywhere/nao_field_2009.bag";
  EXPECT_EQ(judgedImages(replay).first, 40);
  EXPECT_EQ(judgedImages(replay).last, 138);
  replay.bag = "other.bag";
  EXPECT_EQ(judgedImages(replay).first, 1);
}

TEST(StatusText, SaysWhatTheRobotKnows) {
  LiveState live;
  live.first_us = kSecondUs;
  live.now_us = 3'500'000;
  live.memory_segments = 42;
  EXPECT_THAT(statusText(live, std::nullopt),
              testing::AllOf(testing::HasSubstr("2.5 s"), testing::HasSubstr("no pose"),
                             testing::HasSubstr("42 segments")));
  PoseEstimate estimate;
  estimate.T_world_robot = Pose2{1.25, -0.5, std::numbers::pi / 2};
  estimate.reliability = 0.75;
  live.estimate = estimate;
  live.error = PoseError{0, 0.1, 0.0, 0.75};
  GazeStatus gaze;
  gaze.state = GazeState::kTrack;
  gaze.target.emplace();
  gaze.target->p_odom = Eigen::Vector3d(1, 2, 0);
  const std::string text = statusText(live, gaze);
  EXPECT_THAT(text, testing::HasSubstr("gaze tracks segment at 1.0 2.0"));
  EXPECT_THAT(text, testing::HasSubstr("pose 1.25 -0.50 m 90 deg, reliability 0.75"));
  EXPECT_THAT(text, testing::HasSubstr("error 0.10 m 0.0 deg"));
}

TEST(StatusLine, RewritesATerminalsLineAndEndsIt) {
  std::ostringstream terminal;
  StatusLine line(terminal, true);
  line.show("one");
  line.show("two");
  line.end();
  EXPECT_EQ(terminal.str(), "\r\033[Kone\r\033[Ktwo\n");
  std::ostringstream file;
  StatusLine plain(file, false);
  plain.show("one");
  plain.end();
  EXPECT_EQ(file.str(), "one\n");
  const auto now = std::chrono::steady_clock::now();
  EXPECT_TRUE(plain.due(now));
  EXPECT_FALSE(plain.due(now + std::chrono::milliseconds(900)));
  EXPECT_TRUE(plain.due(now + std::chrono::milliseconds(1000)));
}

}  // namespace
}  // namespace vismem
