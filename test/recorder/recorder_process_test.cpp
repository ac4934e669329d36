// Tests C1, C2. The processes over Ice: the simulated application recorded in lock-step, replayed, and
// compared.
#include <Ice/Ice.h>
#include <avm/camera.h>
#include <avm/component.h>
#include <avm/recorder.h>
#include <avm/replay.h>
#include <avm/simulation.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/config/properties.h"
#include "common/recording/bag_file.h"
#include "common/recording/robot_log.h"
#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/eventually.h"
#include "support/ice_client.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string cfg(const std::string& name) {
  return "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/" + name + ".cfg";
}

/// A digest of bytes (FNV-1a): images of a minute are too many to keep.
std::uint64_t digest(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

class RecorderProcessTest : public ::testing::Test {
 protected:
  /// The simulated robot stands still until somebody asks for images.
  std::unique_ptr<ComponentProcess> startSimulator() {
    return startComponent("simulator", {cfg("sim/simulator"), "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0",
                                        "--Simulator.Paused=yes", "--Simulator.Seed=5"});
  }
  /// @param more over the configuration of the setup; its memory and localization are not recorded.
  std::unique_ptr<ComponentProcess> startRecorder(const ComponentProcess& simulator,
                                                  std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{cfg("sim/recorder"),
                                       "--Recorder.Endpoints=tcp -h 127.0.0.1 -p 0",
                                       "--Recorder.Folder=" + (folder_ / "recordings"),
                                       "--Recorder.Name=run",
                                       "--Recorder.Cameras.cameraA.Proxy=" + simulator.proxy("cameraA"),
                                       "--Recorder.Odometry.Proxy=" + simulator.proxy("Encoders"),
                                       "--Recorder.PanTilt.Proxy=" + simulator.proxy("PanTilt"),
                                       "--Recorder.Simulation.Proxy=" + simulator.proxy("Simulation"),
                                       "--Recorder.Components.simulator.Proxy=" + simulator.statusProxy(),
                                       "--Recorder.VisualMemory.Proxy=",
                                       "--Recorder.Gaze.Proxy=",
                                       "--Recorder.Localization.Proxy="};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return startComponent("recorder", std::move(arguments));
  }

  TemporaryFolder folder_;
  IceClient ice_;
};

TEST_F(RecorderProcessTest, AMinuteOfTheApplicationReplaysByteForByte) {
  const auto simulator = startSimulator();
  const auto memory =
      startComponent("active_visual_memory",
                     {cfg("sim/active_visual_memory"), "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0",
                      "--ActiveVisualMemory.Camera.Proxy=" + simulator->proxy("cameraA"),
                      "--ActiveVisualMemory.PanTilt.Proxy=" + simulator->proxy("PanTilt"),
                      "--ActiveVisualMemory.Odometry.Proxy=" + simulator->proxy("Encoders")});
  const auto localization = startComponent(
      "localization",
      {cfg("sim/localization"), "--Localization.Endpoints=tcp -h 127.0.0.1 -p 0",
       "--Localization.VisualMemory.Proxy=" + memory->proxy("VisualMemory"), "--Localization.Gaze.Proxy="});
  const auto recorder =
      startRecorder(*simulator, {"--Recorder.VisualMemory.Proxy=" + memory->proxy("VisualMemory"),
                                 "--Recorder.Gaze.Proxy=" + memory->proxy("Gaze"),
                                 "--Recorder.Localization.Proxy=" + localization->proxy("Localization"),
                                 "--Recorder.Components.active_visual_memory.Proxy=" + memory->statusProxy(),
                                 "--Recorder.Components.localization.Proxy=" + localization->statusProxy()});
  // Time waits for the memory, the recorder and this test: nobody misses an image.
  const auto simulation = ice_.find<avm::SimulationPrx>(*simulator, "Simulation");
  simulation->setLockStep(3);
  simulation->setPaused(false);
  const auto camera = ice_.find<avm::CameraPrx>(*simulator, "cameraA");
  const auto control = ice_.find<avm::RecorderPrx>(*recorder, "Recorder");
  std::map<std::int64_t, std::uint64_t> images;  // by stamp
  Ice::Long last = -1;
  std::int64_t marked_us = 0;
  while (images.empty() || images.rbegin()->first - images.begin()->first < 60'000'000) {
    const avm::FrameResult result = camera->getNext("RGB8", last);
    if (result.state != avm::SourceState::Running) continue;
    last = result.image.seq;
    images[result.image.stampUs] = digest(result.image.pixels);
    if (images.size() == 100) marked_us = control->mark("a hundred images");
  }
  simulation->setLockStep(0);
  simulation->setPaused(true);
  // The recorder has asked for the image after each that it has: it lacks at most the last one.
  ASSERT_TRUE(eventually([&] {
    for (const auto& topic : control->status().topics) {
      if (topic.topic == "/camera/image_raw") return topic.messages >= static_cast<Ice::Long>(images.size());
    }
    return false;
  }));
  const std::string path = control->stop();
  EXPECT_EQ(path, folder_ / "recordings/run");
  EXPECT_EQ(control->status().state, avm::RecorderState::Idle);
  for (const auto& topic : control->status().topics) {
    EXPECT_EQ(topic.dropped, 0) << topic.topic;
    EXPECT_EQ(topic.missed, 0) << topic.topic;
  }
  for (const auto& process : {&recorder, &localization, &memory, &simulator})
    EXPECT_EQ((*process)->stop(kPatience), 0);

  BagFile bag(bagsOf(path));
  std::vector<std::string> names;
  for (const BagTopic& topic : bag.topics()) names.push_back(topic.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf(
                         {"/camera/camera_info", "/camera/image_raw", "/components/localization",
                          "/gaze/status", "/ground_truth/pose", "/joint_states", "/localization/pose", "/map",
                          "/memory/segments", "/memory/snapshot", "/odom", "/recorder/marks", "/tf"}));
  EXPECT_THAT(bag.strings("/recorder/marks"),
              Contains(HasSubstr("\"stamp_us\":" + std::to_string(marked_us))));
  EXPECT_TRUE(fs::exists(fs::path(path) / "map.csv"));
  EXPECT_TRUE(fs::exists(fs::path(path) / "map.palette"));
  EXPECT_TRUE(fs::exists(fs::path(path) / "cfg/active_visual_memory.cfg"));
  const Properties effective = Properties::load(fs::path(path) / "cfg/localization.cfg");
  EXPECT_TRUE(effective.problems().empty());
  EXPECT_NE(effective.find("Localization.Mode"), nullptr);

  // Replayed into a fresh client: every image, every byte, every stamp.
  const auto replay = startComponent(
      "replay_server", {cfg("replay/replay_server"), "--ReplayServer.Start=paused",
                        "--ReplayServer.Endpoints=tcp -h 127.0.0.1 -p 0", "--ReplayServer.File=" + path});
  const auto player = ice_.find<avm::ReplayPrx>(*replay, "Replay");
  const auto again = ice_.find<avm::CameraPrx>(*replay, "cameraA");
  EXPECT_GE(player->contents().images, static_cast<Ice::Long>(images.size()));
  last = -1;
  std::size_t same = 0;
  for (const auto& [stamp_us, hash] : images) {
    const avm::FrameResult result = again->getNext("RGB8", last);
    ASSERT_EQ(result.state, avm::SourceState::Running) << result.message;
    last = result.image.seq;
    ASSERT_EQ(result.image.stampUs, stamp_us);
    ASSERT_EQ(digest(result.image.pixels), hash) << "image at " << stamp_us;
    ++same;
    player->step(1);
  }
  std::cout << same << " images are the same\n";
}

TEST_F(RecorderProcessTest, StartsStopsAndSavesOnDemand) {
  const auto simulator = startSimulator();
  const auto recorder = startRecorder(*simulator, {"--Recorder.StartNow=no", "--Recorder.Ring.Length_s=5",
                                                   "--Recorder.Cameras.cameraA.Images=png"});
  const auto control = ice_.find<avm::RecorderPrx>(*recorder, "Recorder");
  EXPECT_EQ(control->status().state, avm::RecorderState::Idle);
  EXPECT_THROW(control->stop(), avm::Refused);
  EXPECT_THROW(control->start("../elsewhere"), avm::InvalidArgument);
  ice_.find<avm::SimulationPrx>(*simulator, "Simulation")->setPaused(false);
  ASSERT_TRUE(eventually([&] { return control->status().ringS > 1.0; }));
  const std::string ring = control->saveRing("before");
  EXPECT_EQ(control->start("now"), folder_ / "recordings/now");
  EXPECT_THROW(control->start("then"), avm::Refused);
  ASSERT_TRUE(eventually([&] { return control->status().messages > 100; }));
  EXPECT_EQ(control->stop(), folder_ / "recordings/now");
  EXPECT_THROW(control->start("now"), avm::Refused) << "it exists already";
  for (const std::string& path : {ring, folder_ / "recordings/now"}) {
    const RobotLog log = RobotLog::open(path);
    EXPECT_THAT(log.notes(), ::testing::IsEmpty());
    EXPECT_EQ(log.topics().image, "/camera/image_raw/compressed");
    EXPECT_GT(log.frameStamps().size(), 3u);
  }
  // What is on when the process ends is finished.
  control->start("last");
  ASSERT_TRUE(eventually([&] { return control->status().messages > 50; }));
  EXPECT_EQ(recorder->stop(kPatience), 0);
  EXPECT_THAT(bagsOf(folder_ / "recordings/last"), ::testing::Each(::testing::EndsWith(".bag")));
}

TEST_F(RecorderProcessTest, WaitsForItsPeersAndNamesAFullFolder) {
  const auto recorder =
      startComponent("recorder", {"--Recorder.Endpoints=tcp -h 127.0.0.1 -p 0",
                                  "--Recorder.Folder=" + (folder_ / "recordings"), "--Recorder.Name=run",
                                  "--Recorder.Odometry.Proxy=Encoders:tcp -h 127.0.0.1 -p 1"});
  const auto status = ice_.find<avm::ComponentPrx>(*recorder, "recorder/component");
  EXPECT_TRUE(eventually([&] { return status->getStatus().state == avm::ComponentState::WaitingForPeers; }));
  EXPECT_EQ(recorder->stop(kPatience), 0);
  const ComponentProcess second("recorder",
                                {"--Recorder.Endpoints=tcp -h 127.0.0.1 -p 0",
                                 "--Recorder.Folder=" + (folder_ / "recordings"), "--Recorder.Name=run"});
  EXPECT_EQ(second.waitForExit(kPatience), 1);
  EXPECT_THAT(second.error(), HasSubstr("recordings/run: exists already"));
  const ComponentProcess third(
      "recorder", {"--Recorder.Endpoints=tcp -h 127.0.0.1 -p 0", "--Recorder.Folder=/proc/recordings"});
  EXPECT_EQ(third.waitForExit(kPatience), 1);
  EXPECT_THAT(third.error(), HasSubstr("Recorder.Folder = /proc/recordings (cannot be made: "));
}

// A service that is restarted at once shall record on.
TEST_F(RecorderProcessTest, StartsSeveralTimesWithinASecond) {
  for (int i = 0; i < 4; ++i) {
    const auto recorder = startComponent(
        "recorder", {"--Recorder.Endpoints=tcp -h 127.0.0.1 -p 0",
                     "--Recorder.Folder=" + (folder_ / "recordings"), "--Recorder.StartNow=yes"});
    const auto control = ice_.find<avm::RecorderPrx>(*recorder, "Recorder");
    EXPECT_TRUE(eventually([&] { return control->status().state == avm::RecorderState::Recording; }));
    EXPECT_EQ(recorder->stop(kPatience), 0) << recorder->error();
  }
}

// A oneway call of an operation with a result cannot be answered.
TEST_F(RecorderProcessTest, OnewayCommandsAreCarriedOut) {
  const auto simulator = startSimulator();
  const auto recorder = startRecorder(*simulator);
  const auto control = ice_.find<avm::RecorderPrx>(*recorder, "Recorder");
  Ice::OutputStream name(control->ice_getCommunicator());
  name.startEncapsulation();
  name.write(std::string("oneway"), false);
  name.endEncapsulation();
  Ice::ByteSeq parameters;
  name.finished(parameters);
  Ice::ByteSeq nothing;
  for (const char* state : {"Idle", "Recording"}) {
    const bool starts = state == std::string("Recording");
    control->ice_oneway()->ice_invoke(starts ? "start" : "stop", Ice::OperationMode::Normal,
                                      starts ? parameters : Ice::ByteSeq{}, nothing);
    const auto wanted = starts ? avm::RecorderState::Recording : avm::RecorderState::Idle;
    EXPECT_TRUE(eventually([&] { return control->status().state == wanted; })) << "never " << state;
  }
  EXPECT_TRUE(recorder->running());
}

}  // namespace
}  // namespace vismem
