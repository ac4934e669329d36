// The process camera_server over Ice: several cameras, formats, cameras that disappear and return.
// Tests C1, C3, C4.
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "common/geometry/angles.h"
#include "common/robot_ice/camera_ice.h"
#include "support/build_paths.h"
#include "support/ice_client.h"
#include "support/mjpeg_server.h"
#include "support/pictures.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

const std::string kEndpoint = "--CameraServer.Endpoints=tcp -h 127.0.0.1 -p 0";

std::string key(const std::string& camera, const std::string& name, const std::string& value) {
  return "--CameraServer.Camera." + camera + "." + name + "=" + value;
}

Frame awaitFrame(RemoteFrameSource& camera) {
  FrameResult result;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    result = camera.next(200ms);
    if (result.frame) return *std::move(result.frame);
  }
  ADD_FAILURE() << "no frame: " << result.message;
  return {};
}

/// Waits until the state's reason contains a text; an empty one waits for running.
std::string awaitReason(avm::ComponentPrx& status, const std::string& text) {
  std::string reason;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    const auto report = status.getStatus();
    reason = report.reason;
    const bool there =
        text.empty() ? report.state == avm::ComponentState::Running : reason.find(text) != std::string::npos;
    if (there) return reason;
    std::this_thread::sleep_for(10ms);
  }
  return "not in time: " + reason;
}

TEST(CameraServer, ServesSeveralCamerasAndEndsOnSigterm) {
  const TemporaryFolder folder;
  writePicture(folder / "1.jpg", 100, 64, 48);
  ComponentProcess server(
      "camera_server",
      {kEndpoint, key("cameraA", "Driver", "files"), key("cameraA", "Source", folder.path().string()),
       key("cameraA", "Rate_hz", "50"), key("rear", "Driver", "pattern"), key("rear", "Width_px", "120"),
       key("rear", "Height_px", "160"), key("rear", "Rotate_deg", "90"),
       key("rear", "HorizontalView_deg", "50")});
  ASSERT_TRUE(server.waitUntilReady());
  IceClient ice;
  RemoteFrameSource front(ice.find<avm::CameraPrx>(server, "cameraA"));
  EXPECT_EQ(awaitFrame(front).image.size(), cv::Size(64, 48));
  RemoteFrameSource rear(ice.find<avm::CameraPrx>(server, "rear"), FrameFormat::kYuy2);
  const Frame turned = awaitFrame(rear);
  EXPECT_EQ(turned.image.size(), cv::Size(120, 160));
  EXPECT_EQ(turned.intrinsics, intrinsicsFromFieldOfView(120, 160, degToRad(50.0)));

  const auto status = ice.find<avm::ComponentPrx>(server, "camera_server/component");
  const auto report = status->getStatus();
  EXPECT_EQ(report.state, avm::ComponentState::Running) << report.reason;
  std::vector<std::string> rates;
  for (const auto& rate : report.rates) rates.push_back(rate.name);
  EXPECT_THAT(rates, testing::UnorderedElementsAre("cameraA", "rear"));
  ASSERT_TRUE(server.signal(SIGTERM));
  EXPECT_EQ(server.waitForExit(kPatience), 0) << server.error();
}

TEST(CameraServer, PassesTheFilesJpegOnAndServesJdeRobotsFormats) {
  const TemporaryFolder folder;
  writePicture(folder / "1.jpg", 100, 63, 47);
  std::ifstream in(folder / "1.jpg", std::ios::binary);
  const jderobot::ByteSeq bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  ComponentProcess server("camera_server", {kEndpoint, key("cameraA", "Driver", "files"),
                                            key("cameraA", "Source", folder / "1.jpg")});
  ASSERT_TRUE(server.waitUntilReady());
  IceClient ice;
  const auto camera = ice.find<avm::CameraPrx>(server, "cameraA");
  EXPECT_EQ(camera->getNext("JPEG", -1).image.pixels, bytes);
  EXPECT_THAT(camera->getImageFormat(), testing::ElementsAre("RGB8", "GRAY8", "JPEG", "YUY2"));
  EXPECT_EQ(camera->getImageData("JPEG")->pixelData, bytes);
  EXPECT_EQ(camera->getImageData("RGB8")->pixelData.size(), 63U * 47 * 3);
  EXPECT_EQ(camera->getImageData("GRAY8")->pixelData.size(), 63U * 47);
  EXPECT_EQ(camera->getImageData("YUY2")->pixelData.size(), 32U * 4 * 47);
  EXPECT_THROW(camera->getImageData("BGR8"), jderobot::DataNotExistException);
}

TEST(CameraServer, ACameraThatIsAwayDegradesItAloneAndComesBack) {
  const TemporaryFolder folder;
  const std::filesystem::path absent = folder.path() / "walk";
  ComponentProcess server(
      "camera_server",
      {kEndpoint, key("cameraA", "Driver", "files"), key("cameraA", "Source", absent.string()),
       key("cameraA", "Rate_hz", "50"), key("rear", "Driver", "pattern")});
  ASSERT_TRUE(server.waitUntilReady());
  IceClient ice;
  const auto status = ice.find<avm::ComponentPrx>(server, "camera_server/component");
  EXPECT_THAT(awaitReason(*status, "cameraA"), HasSubstr("walk: no such file or folder"));
  RemoteFrameSource front(ice.find<avm::CameraPrx>(server, "cameraA"));
  RemoteFrameSource rear(ice.find<avm::CameraPrx>(server, "rear"));
  awaitFrame(rear);
  EXPECT_THAT(front.next(3s).message, HasSubstr("no such file or folder")) << "the client gets the reason";

  std::filesystem::create_directories(absent);
  writePicture((absent / "1.png").string(), 10);
  awaitFrame(front);
  EXPECT_EQ(awaitReason(*status, ""), "");
  std::filesystem::remove_all(absent);
  EXPECT_THAT(awaitReason(*status, "cameraA"), HasSubstr("walk"));
  awaitFrame(rear);
  std::filesystem::create_directories(absent);
  writePicture((absent / "1.png").string(), 20);
  EXPECT_EQ(awaitReason(*status, ""), "");
  awaitFrame(front);
}

TEST(CameraServer, EndsInTimeWhileAStreamSaysNothing) {
  MjpegServer silent(MjpegServer::Manner::kSilent);
  ComponentProcess server(
      "camera_server", {kEndpoint, key("cameraA", "Driver", "files"), key("cameraA", "Source", silent.url()),
                        key("cameraA", "OpenTimeout_s", "1")});
  ASSERT_TRUE(server.waitUntilReady());
  for (const auto deadline = Clock::now() + kPatience;
       silent.connections() == 0 && Clock::now() < deadline;) {
    std::this_thread::sleep_for(5ms);
  }
  const auto began = Clock::now();
  ASSERT_TRUE(server.signal(SIGTERM));
  EXPECT_EQ(server.waitForExit(kPatience), 0) << server.error();
  EXPECT_LT(Clock::now() - began, 5s);
}

TEST(CameraServer, TheShippedConfigurationRuns) {
  ComponentProcess server("camera_server",
                          {"--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/files/camera_server.cfg", kEndpoint});
  ASSERT_TRUE(server.waitUntilReady());
  IceClient ice;
  RemoteFrameSource camera(ice.find<avm::CameraPrx>(server, "cameraA"));
  const Frame frame = awaitFrame(camera);
  EXPECT_EQ(frame.image.size(), cv::Size(320, 240));
  EXPECT_EQ(frame.intrinsics.width, 320);
  EXPECT_NEAR(frame.intrinsics.fx, 277.128, 0.01) << "of the calibration file";
  const auto status = ice.find<avm::ComponentPrx>(server, "camera_server/component");
  EXPECT_EQ(awaitReason(*status, ""), "");
}

TEST(CameraServer, NamesWhatIsWrongWithItsConfiguration) {
  ComponentProcess server("camera_server",
                          {kEndpoint, key("cameraA", "Driver", "film"), key("rear", "Driver", "pattern"),
                           key("rear", "Bars", "1"), key("rear", "Wdth_px", "3")});
  EXPECT_EQ(server.waitForExit(kPatience), 2);
  EXPECT_THAT(server.error(),
              HasSubstr("CameraServer.Camera.cameraA.Driver = film (unknown driver (did you mean "
                        "\"files\"?); must be one of: files, pattern, v4l2)"));
  EXPECT_THAT(server.error(), HasSubstr("CameraServer.Camera.rear.Bars = 1 (must be 2..64)"));
  EXPECT_THAT(server.error(), HasSubstr("unknown key \"CameraServer.Camera.rear.Wdth_px\" (did you mean "
                                        "\"CameraServer.Camera.rear.Width_px\"?)"));
}

}  // namespace
}  // namespace vismem
