#include "application/app/launcher.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "application/app/session_setup.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

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

TEST(LastWords, LeaveOutTheConfigurationAndNameTheWayOutOfATakenPort) {
  const std::string log =
      "2026-11-28 00:12:27.810 gui_server INFO configuration:\n"
      "    Ice.MessageSizeMax = 16384\n"
      "2026-11-28 00:12:27.817 gui_server ERROR GuiServer.Http.Endpoints = http -p 8770 (the address is in "
      "use)\n";
  EXPECT_EQ(
      lastWords(log),
      "\n  2026-11-28 00:12:27.817 gui_server ERROR GuiServer.Http.Endpoints = http -p 8770 (the address is "
      "in use)\n  Another run may have this port: --port-offset 100 adds 100 to every port.");
  EXPECT_EQ(lastWords("cfg/sim/simulator.cfg:3: wrong\n"), "\n  cfg/sim/simulator.cfg:3: wrong");
}

TEST(Commands, NameTheConfigurationAndWhatTheRunSets) {
  RunOptions options = simulation();
  options.seed = 7;
  options.port_offset = 1000;
  const auto commands = commandsOf(options);
  ASSERT_EQ(commands.size(), 4u);
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
  EXPECT_EQ(commands[3].name, "gui_server");
  EXPECT_EQ(pageAddressOf(options), "http://127.0.0.1:9770/");
}

/// @return the argument that sets the token; empty without one.
std::string tokenOf(const ComponentCommand& command) {
  for (const auto& argument : command.arguments) {
    if (argument.starts_with("--Robot.Token=")) return argument;
  }
  return "";
}

TEST(Commands, GiveAllComponentsTheSameNewTokenAtEachStart) {
  const RunOptions options = simulation();
  const auto first = commandsOf(options);
  const auto second = commandsOf(options);
  EXPECT_EQ(tokenOf(first[0]).size(), std::string("--Robot.Token=").size() + 32);
  for (const auto& command : first) EXPECT_EQ(tokenOf(command), tokenOf(first[0])) << command.name;
  EXPECT_NE(tokenOf(first[0]), tokenOf(second[0]));
}

TEST(Commands, WithoutThePageNothingAnswersPages) {
  RunOptions options = simulation();
  options.gui = false;
  const auto commands = commandsOf(options);
  ASSERT_EQ(commands.size(), 3u);
  for (const auto& command : commands) EXPECT_EQ(tokenOf(command), "") << command.name;
  EXPECT_EQ(pageAddressOf(options), "");
}

TEST(Commands, RecordIntoTheFolderOfTheResults) {
  RunOptions options = simulation();
  options.record = true;
  options.gui = false;
  options.out = "/somewhere";
  options.port_offset = 1000;
  const auto commands = commandsOf(options);
  ASSERT_EQ(commands.size(), 4u);
  EXPECT_EQ(commands[3].name, "recorder");
  EXPECT_THAT(commands[3].arguments, testing::Contains(testing::EndsWith("cfg/sim/recorder.cfg")));
  EXPECT_THAT(commands[3].arguments, testing::Contains("--Recorder.Folder=/somewhere"));
  EXPECT_THAT(commands[3].arguments, testing::Contains("--Recorder.Name=recording"));
  EXPECT_THAT(commands[3].arguments,
              testing::Contains("--Recorder.Cameras.cameraA.Proxy=cameraA:tcp -h 127.0.0.1 -p 10999"));
}

TEST(Commands, GiveThePageTheRecordersProxies) {
  RunOptions options = simulation();
  options.port_offset = 1000;
  const auto recorderOfPage = testing::Contains(testing::HasSubstr("GuiServer.Recorder.Proxy"));
  EXPECT_THAT(commandsOf(options).back().arguments, Not(recorderOfPage));
  options.record = true;
  options.out = "/somewhere";
  EXPECT_THAT(commandsOf(options).back().arguments,
              testing::AllOf(
                  testing::Contains("--GuiServer.Recorder.Proxy=Recorder:ws -h 127.0.0.1 -p 12008"),
                  testing::Contains(
                      "--GuiServer.Components.recorder.Proxy=recorder/component:ws -h 127.0.0.1 -p 12008")));
}

TEST(Commands, TakeASessionsConfigurationsAtTheReplaysPlaces) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "cfg");
  std::ofstream(folder / "cfg/active_visual_memory.cfg")
      << "ActiveVisualMemory.Camera.Proxy = cameraA:tcp -h 10.0.0.7 -p 5\n"
         "ActiveVisualMemory.PanTilt.Proxy = PanTilt:tcp -h 10.0.0.7 -p 6\n"
         "ActiveVisualMemory.Mode = chapter\n";
  std::ofstream(folder / "cfg/localization.cfg") << "Localization.Gaze.Proxy = Gaze:tcp -h 10.0.0.7 -p 7\n";
  RunOptions options = simulation();
  options.setup = Setup::kReplay;
  options.folder = "replay";
  options.session = options.bag = folder.path();
  options.gui = false;
  options.port_offset = 1000;
  const auto commands = commandsOf(options);
  ASSERT_EQ(commands.size(), 3u);
  EXPECT_THAT(commands[0].arguments, testing::Contains("--ReplayServer.File=" + folder.path().string()));
  const auto& memory = commands[1].arguments;
  EXPECT_THAT(memory, testing::Contains("--Ice.Config=" + (folder / "cfg/active_visual_memory.cfg")));
  EXPECT_THAT(memory,
              testing::Contains("--ActiveVisualMemory.Camera.Proxy=cameraA:tcp -h 127.0.0.1 -p 10999"));
  EXPECT_THAT(memory,
              testing::Contains("--ActiveVisualMemory.PanTilt.Proxy=PanTilt:tcp -h 127.0.0.1 -p 10977"));
  EXPECT_THAT(memory, testing::Contains(
                          testing::StartsWith("--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 10970")));
  EXPECT_THAT(commands[2].arguments,
              testing::Contains("--Localization.Gaze.Proxy=Gaze:tcp -h 127.0.0.1 -p 10970"));
}

TEST(SessionSetup, AProxyFindsItsObjectInTheReplay) {
  EXPECT_EQ(proxyInReplay("Encoders:tcp -h host -p 1:ws -p 2", 5), "Encoders:tcp -h 127.0.0.1 -p 10002");
  EXPECT_EQ(proxyInReplay("Motors@Adapter", 0), "Motors:tcp -h 127.0.0.1 -p 9990");
  EXPECT_EQ(proxyInReplay("Simulation:tcp -p 9972", 0), "") << "a recording has no world";
}

}  // namespace
}  // namespace vismem
