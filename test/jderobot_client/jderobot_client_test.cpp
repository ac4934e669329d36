// Clients of JdeRobot 5.6.7 work unchanged: a Python program that uses only interfaces/jderobot grabs images,
// turns the pan-tilt unit, drives the base, reads encoders and poses, and plays a recording.
// Tests C4.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "recording/bag_writer.h"
#include "support/build_paths.h"
#include "support/component_process.h"

namespace vismem {
namespace {

const std::string kRoot = VISMEM_SOURCE_DIR;

/// The client's checks take some seconds; it gives up waiting by itself.
constexpr std::chrono::seconds kClientsTime{100};

testing::AssertionResult client(std::vector<std::string> arguments) {
  std::vector<std::string> command{"/usr/bin/python3", "-B",
                                   kRoot + "/test/jderobot_client/jderobot_client.py", kRoot + "/interfaces"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ChildProcess process(command);
  const auto code = process.waitForExit(kClientsTime);
  if (code == 0) {
    std::cout << process.out();
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << (code ? "exit code " + std::to_string(*code) : "it does not end")
                                     << "\n"
                                     << process.out() << process.error();
}

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("jderobot_client_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::vector<std::uint8_t> bytesOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The process with its own configuration, at a port of the system's choice.
std::unique_ptr<ComponentProcess> serve(const std::string& name, const std::string& config,
                                        const std::string& prefix, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"--Ice.Config=" + kRoot + "/cfg/" + config,
                                     "--" + prefix + ".Endpoints=tcp -h 127.0.0.1 -p 0"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return std::make_unique<ComponentProcess>(name, arguments);
}
std::unique_ptr<ComponentProcess> simulator(std::vector<std::string> more = {}) {
  return serve("simulator", "sim/simulator.cfg", "Simulator", std::move(more));
}

/// Images in each format, of a picture that stands still.
void grabInEachFormat(const ComponentProcess& server) {
  const Folder out;
  ASSERT_TRUE(client({"camera", server.proxy("cameraA"), "320", "240", out / ""}));
  // Checked here, because Python cannot decode it: the JPEG has the same content.
  const auto jpeg = bytesOf(out / "JPEG");
  const cv::Mat decoded = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  auto rgb = bytesOf(out / "RGB8");
  ASSERT_EQ(rgb.size(), 3U * 320 * 240);
  ASSERT_EQ(decoded.size(), cv::Size(320, 240));
  double difference = 0.0;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      difference += std::abs(rgb[i + channel] - decoded.data[i + 2 - channel]);  // OpenCV's order is B G R
    }
  }
  EXPECT_LT(difference / static_cast<double>(rgb.size()), 3.0);
}

TEST(JdeRobotClient, GrabsImagesOfTheSimulatorInEachFormat) {
  const auto server = simulator({"--Simulator.Camera.Noise=0"});
  ASSERT_TRUE(server->waitUntilReady());
  grabInEachFormat(*server);
}

TEST(JdeRobotClient, GrabsImagesOfACameraServerInEachFormat) {
  const auto server = serve("camera_server", "files/camera_server.cfg", "CameraServer");
  ASSERT_TRUE(server->waitUntilReady());
  grabInEachFormat(*server);
}

TEST(JdeRobotClient, SeesPanToTheLeftAndTiltUp) {
  const auto server = simulator();
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"looking", server->proxy("PanTilt"), server->proxy("cameraA")}));
}

TEST(JdeRobotClient, TurnsThePanTiltOfTheSimulator) {
  const auto server = simulator();
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"pantilt", server->proxy("PanTilt"), "0.45"}));
}

TEST(JdeRobotClient, TurnsThePanTiltOfItsServer) {
  const auto server = serve("pantilt_server", "files/pantilt_server.cfg", "PanTiltServer");
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"pantilt", server->proxy("PanTilt"), "0.45"}));
}

TEST(JdeRobotClient, DrivesTheBaseOfTheSimulator) {
  const auto server = simulator();
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"base", server->proxy("Motors"), server->proxy("Encoders"), server->proxy("cameraA")}));
}

TEST(JdeRobotClient, DrivesABaseWhoseMotorsAndEncodersAreOneServer) {
  const auto server = serve("base_server", "files/base_server.cfg", "BaseServer");
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"base", server->proxy("Motors"), server->proxy("Encoders")}));
}

TEST(JdeRobotClient, SetsAndReadsThePoseInTheWorld) {
  const auto robot = simulator();
  ASSERT_TRUE(robot->waitUntilReady());
  const auto memory = serve("active_visual_memory", "sim/active_visual_memory.cfg", "ActiveVisualMemory",
                            {"--ActiveVisualMemory.Camera.Proxy=" + robot->proxy("cameraA"),
                             "--ActiveVisualMemory.PanTilt.Proxy=" + robot->proxy("PanTilt"),
                             "--ActiveVisualMemory.Odometry.Proxy=" + robot->proxy("Encoders")});
  ASSERT_TRUE(memory->waitUntilReady());
  const auto localization = serve("localization", "sim/localization.cfg", "Localization",
                                  {"--Localization.VisualMemory.Proxy=" + memory->proxy("VisualMemory")});
  ASSERT_TRUE(localization->waitUntilReady());
  // The start pose of cfg/sim/simulator.cfg.
  EXPECT_TRUE(
      client({"pose", localization->proxy("Localization"), robot->proxy("Motors"), "3", "2.25", "180"}))
      << localization->error();
}

TEST(JdeRobotClient, ControlsARecording) {
  const Folder folder;
  const std::string file = folder / "recording.bag";
  {
    BagWriter bag(file);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    for (int i = 0; i <= 20; ++i) {
      const std::int64_t stamp_us = 1'000'000 + 100'000 * i;
      bag.image("/camera/image_raw", stamp_us, "mono8", 16, 16, std::vector<std::uint8_t>(256, 7));
      bag.odometry("/odom", stamp_us, 0.1 * i, 0.0, 0.0);
      bag.joints("/joint_states", stamp_us, {"pan", "tilt"}, {0.1 * i, 0.2});
    }
    bag.close();
  }
  const auto server = serve("replay_server", "replay/replay_server.cfg", "ReplayServer",
                            {"--ReplayServer.File=" + file, "--ReplayServer.Start=paused"});
  ASSERT_TRUE(server->waitUntilReady());
  EXPECT_TRUE(client({"replay", server->proxy("Replay"), "2000"}));
}

}  // namespace
}  // namespace vismem
