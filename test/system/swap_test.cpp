// The same components on the simulator, on the servers of files and simulated motion, and on a recording:
// only proxies differ. See C2.
#include <avm/component.h>
#include <avm/visual_memory.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <thread>

#include "common/config/properties.h"
#include "common/robot_ice/camera_ice.h"
#include "recording/bag_writer.h"
#include "support/build_paths.h"
#include "support/ice_client.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* kAnyPort = "=tcp -h 127.0.0.1 -p 0";

/// Proxies to the parts of a robot.
struct Robot {
  std::string camera;
  std::string pan_tilt;
  std::string odometry;
};

/// Components of the build, at ports of the system's choice.
class Processes {
 public:
  /// @param setup folder of cfg/ that holds its configuration. @param changes keys that differ from it.
  ComponentProcess& start(const std::string& name, const std::string& prefix, const std::string& setup,
                          const std::map<std::string, std::string>& changes = {}) {
    std::vector<std::string> arguments{"--Ice.Config=cfg/" + setup + "/" + name + ".cfg",
                                       "--" + prefix + ".Endpoints" + kAnyPort};
    for (const auto& [key, value] : changes) arguments.push_back("--" + key + "=" + value);
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    all_.push_back(std::make_unique<ComponentProcess>(name, std::move(arguments), std::move(options)));
    EXPECT_TRUE(all_.back()->waitUntilReady());
    return *all_.back();
  }

 private:
  std::vector<std::unique_ptr<ComponentProcess>> all_;
};

std::int64_t totalOf(avm::ComponentPrx& component, const std::string& rate) {
  for (const auto& counted : component.getStatus().rates) {
    if (counted.name == rate) return counted.total;
  }
  return 0;
}

/// Two components that find each other again take longer than one.
bool settles(const std::function<bool()>& condition) {
  return eventually(condition, 2 * kPatience);
}

/// The two components of the chapter as cfg/sim configures them, but for their proxies.
/// @param reason in the memory's status; empty: it is running.
void expectTheyWorkOn(const Robot& robot, Processes& processes, const std::string& reason = "") {
  const std::map<std::string, std::string> memory_changes{
      {"ActiveVisualMemory.Camera.Proxy", robot.camera},
      {"ActiveVisualMemory.PanTilt.Proxy", robot.pan_tilt},
      {"ActiveVisualMemory.Odometry.Proxy", robot.odometry}};
  auto& memory = processes.start("active_visual_memory", "ActiveVisualMemory", "sim", memory_changes);
  const std::map<std::string, std::string> localization_changes{
      {"Localization.VisualMemory.Proxy", memory.proxy("VisualMemory")},
      {"Localization.Gaze.Proxy", memory.proxy("Gaze")}};
  auto& localization = processes.start("localization", "Localization", "sim", localization_changes);
  for (const auto& changes : {memory_changes, localization_changes}) {
    for (const auto& [key, value] : changes) EXPECT_TRUE(key.ends_with(".Proxy")) << key;
  }

  IceClient ice;
  const auto memory_status = ice.find<avm::ComponentPrx>(memory, "active_visual_memory/component");
  const auto localization_status = ice.find<avm::ComponentPrx>(localization, "localization/component");
  constexpr std::int64_t kEnough = 10;
  EXPECT_TRUE(settles([&] { return totalOf(*memory_status, "frames") >= kEnough; }))
      << "frames: " << totalOf(*memory_status, "frames") << "\n"
      << memory.error();
  EXPECT_TRUE(settles([&] { return totalOf(*memory_status, "iterations") >= kEnough; }))
      << "images in the memory: " << totalOf(*memory_status, "iterations") << "\n"
      << memory.error();
  EXPECT_TRUE(settles([&] { return totalOf(*localization_status, "estimates") >= kEnough; }))
      << "estimates: " << totalOf(*localization_status, "estimates") << "\n"
      << localization.error();
  const auto visual_memory = ice.find<avm::VisualMemoryPrx>(memory, "VisualMemory");
  auto update = visual_memory->next(0);
  EXPECT_EQ(update.state, avm::SourceState::Running) << update.message;
  EXPECT_GT(update.update.snapshot.stampUs, 0);
  // Elements of few images are unconfirmed, and not every image is used while the head turns.
  EXPECT_TRUE(settles([&] {
    if (update.update.snapshot.segments.empty())
      update = visual_memory->next(update.update.snapshot.revision);
    return !update.update.snapshot.segments.empty();
  })) << "the corridor is in view";
  const auto status = memory_status->getStatus();
  EXPECT_EQ(status.state, reason.empty() ? avm::ComponentState::Running : avm::ComponentState::Degraded);
  EXPECT_EQ(status.reason, reason);
}

TEST(Swap, TheSimulator) {
  Processes processes;
  auto& simulator = processes.start("simulator", "Simulator", "sim");
  expectTheyWorkOn({simulator.proxy("cameraA"), simulator.proxy("PanTilt"), simulator.proxy("Encoders")},
                   processes);
}

TEST(Swap, TheServersOfFilesAndSimulatedMotion) {
  Processes processes;
  auto& camera = processes.start("camera_server", "CameraServer", "files");
  auto& pan_tilt = processes.start("pantilt_server", "PanTiltServer", "files");
  auto& base = processes.start("base_server", "BaseServer", "files");
  expectTheyWorkOn({camera.proxy("cameraA"), pan_tilt.proxy("PanTilt"), base.proxy("Encoders")}, processes);
}

/// The shipped view of the corridor as a recording of 60 s, at rest.
void writeRecording(const std::string& file) {
  std::ifstream in(VISMEM_SOURCE_DIR "/cfg/files/corridor.jpg", std::ios::binary);
  const std::vector<std::uint8_t> jpeg((std::istreambuf_iterator<char>(in)),
                                       std::istreambuf_iterator<char>());
  BagWriter bag(file);
  bag.cameraInfo("/camera/camera_info", 1'000'000, 320, 240, 277.12813);
  for (std::int64_t stamp_us = 1'000'000; stamp_us < 61'000'000; stamp_us += 50'000) {
    if (stamp_us % 100'000 == 0) bag.compressedImage("/camera/image_raw/compressed", stamp_us, jpeg);
    bag.odometry("/odom", stamp_us, 0.0, 0.0, 0.0);
    bag.joints("/joint_states", stamp_us, {"pan", "tilt"}, {0.0, -0.14});
  }
  bag.close();
}

TEST(Swap, TheReplayServer) {
  const TemporaryFolder folder;
  writeRecording(folder / "corridor.bag");
  Processes processes;
  auto& replay =
      processes.start("replay_server", "ReplayServer", "replay",
                      {{"ReplayServer.File", folder / "corridor.bag"}, {"ReplayServer.Loop", "yes"}});
  // It looks around as before; its commands are accepted and ignored.
  expectTheyWorkOn({replay.proxy("cameraA"), replay.proxy("PanTilt"), replay.proxy("Encoders")}, processes);
}

/// Keys whose values differ between two files.
std::vector<std::string> differences(const std::string& a, const std::string& b) {
  const Properties first = Properties::load(std::string(VISMEM_SOURCE_DIR "/") + a);
  const Properties second = Properties::load(std::string(VISMEM_SOURCE_DIR "/") + b);
  first.throwIfBad();
  second.throwIfBad();
  EXPECT_FALSE(first.entries().empty());
  std::vector<std::string> keys;
  for (const auto& [key, entry] : first.entries()) {
    const auto* other = second.find(key);
    if (other == nullptr || other->value != entry.value) keys.push_back(key);
  }
  for (const auto& [key, entry] : second.entries()) {
    if (first.find(key) == nullptr) keys.push_back(key);
  }
  return keys;
}

TEST(Swap, TheShippedConfigurationsDifferInProxiesOnly) {
  for (const std::string name : {"active_visual_memory", "localization"}) {
    for (const auto& key : differences("cfg/sim/" + name + ".cfg", "cfg/files/" + name + ".cfg")) {
      EXPECT_TRUE(key.ends_with(".Proxy")) << name << ": " << key;
    }
  }
}

}  // namespace
}  // namespace vismem
