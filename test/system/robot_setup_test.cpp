// The setup of a robot (cfg/robot): the whole application starts without the devices, names them, and runs
// once they appear. The devices are emulated: a robot and a pan-tilt unit on pseudo terminals, a camera on
// umockdev.
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <memory>
#include <thread>

#include "support/build_paths.h"
#include "support/emulated_camera.h"
#include "support/ice_client.h"
#include "support/p2os_robot.h"
#include "support/ptu46_device.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class RobotSetup : public testing::Test {
 protected:
  std::unique_ptr<ComponentProcess> start(const std::string& name, const std::string& prefix,
                                          std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"--Ice.Config=cfg/robot/" + name + ".cfg",
                                       "--" + prefix + ".Endpoints=tcp -h 127.0.0.1 -p 0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    auto process = std::make_unique<ComponentProcess>(name, arguments, options);
    EXPECT_TRUE(process->waitUntilReady());
    return process;
  }
  avm::ComponentStatus status(const ComponentProcess& process, const std::string& name) {
    return ice.find<avm::ComponentPrx>(process, name + "/component")->getStatus();
  }
  /// @return its reason, once it is not running as it should.
  std::string reason(const ComponentProcess& process, const std::string& name) {
    eventually([&] { return !status(process, name).reason.empty(); });
    return status(process, name).reason;
  }

  IceClient ice;
};

TEST_F(RobotSetup, NamesTheDevicesThatAreAbsent) {
  const auto base = start("base_server", "BaseServer");
  const auto pan_tilt = start("pantilt_server", "PanTiltServer");
  const auto camera = start("camera_server", "CameraServer");
  EXPECT_EQ(reason(*base, "base_server"), "base: /dev/ttyPIONEER: no such device");
  EXPECT_EQ(reason(*pan_tilt, "pantilt_server"), "pan-tilt unit: /dev/ttyPTU: no such device");
  EXPECT_EQ(reason(*camera, "camera_server"), "cameraA: /dev/videoROBOT: no such device");
}

TEST_F(RobotSetup, RunsOnceTheDevicesAppear) {
  P2osRobot robot;
  Ptu46Device unit;
  robot.unplug();
  unit.unplug();
  EmulatedCamera webcam;
  webcam.unplug();
  const auto base = start("base_server", "BaseServer", {"--BaseServer.Port=" + robot.path()});
  const auto pan_tilt = start("pantilt_server", "PanTiltServer", {"--PanTiltServer.Port=" + unit.path()});
  const auto camera =
      start("camera_server", "CameraServer", {"--CameraServer.Camera.cameraA.Device=" + webcam.path()});
  const auto memory = start("active_visual_memory", "ActiveVisualMemory",
                            {"--ActiveVisualMemory.Camera.Proxy=" + camera->proxy("cameraA"),
                             "--ActiveVisualMemory.PanTilt.Proxy=" + pan_tilt->proxy("PanTilt"),
                             "--ActiveVisualMemory.Odometry.Proxy=" + base->proxy("Encoders")});
  const auto localization = start("localization", "Localization",
                                  {"--Localization.VisualMemory.Proxy=" + memory->proxy("VisualMemory"),
                                   "--Localization.Gaze.Proxy=" + memory->proxy("Gaze")});
  EXPECT_THAT(reason(*base, "base_server"), HasSubstr("no such device"));
  EXPECT_THAT(reason(*pan_tilt, "pantilt_server"), HasSubstr("no such device"));
  EXPECT_EQ(reason(*camera, "camera_server"), "cameraA: /dev/video0: no such device");
  robot.plugIn();
  unit.plugIn();
  webcam.plugIn();
  for (const auto& [process, name] : {std::pair{base.get(), "base_server"},
                                      {pan_tilt.get(), "pantilt_server"},
                                      {camera.get(), "camera_server"},
                                      {memory.get(), "active_visual_memory"},
                                      {localization.get(), "localization"}}) {
    EXPECT_TRUE(eventually([&] { return status(*process, name).state == avm::ComponentState::Running; }))
        << name << ": " << status(*process, name).reason;
  }
  // The gaze moves the unit that has appeared.
  EXPECT_TRUE(eventually([&] {
    const auto at = unit.position();
    return at[0] != 0.0 || at[1] != 0.0;
  }));
  for (ComponentProcess* process :
       {localization.get(), memory.get(), camera.get(), pan_tilt.get(), base.get()}) {
    EXPECT_TRUE(process->signal(SIGTERM));
    EXPECT_EQ(process->waitForExit(kPatience), 0);
  }
}

}  // namespace
}  // namespace vismem
