// The robot that calibrate body drives, over Ice. Tests B5.
#include "calibration/app/body_robot.h"

#include <gtest/gtest.h>

#include "avm/lease.h"
#include "support/component_process.h"
#include "support/eventually.h"

namespace vismem {
namespace {

TEST(LeasedRobot, KeepsBothLeasesWhileItCommandsNothing) {
  ComponentProcess simulator(
      "simulator", {"--Simulator.World=" + std::string(VISMEM_SOURCE_DIR) + "/cfg/worlds/corridor.world",
                    "--Simulator.Start.Position_m=3 2.25", "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"});
  ASSERT_TRUE(simulator.waitUntilReady());
  ActiveVisualMemoryConfig setup;
  setup.camera_proxy = simulator.proxy("cameraA");
  setup.odometry_proxy = simulator.proxy("Encoders");
  setup.pan_tilt_proxy = simulator.proxy("PanTilt");
  LeasedRobot robot(setup, simulator.proxy("Motors"), 0);

  const Ice::CommunicatorHolder ice(Ice::initialize());
  const auto remaining_s = [&](const char* identity) {
    const auto actuator = ice->stringToProxy(simulator.proxy(identity));
    return Ice::uncheckedCast<avm::LeasablePrx>(actuator)->holder().remainingS;
  };
  // Renewed once a second, and both at once.
  EXPECT_TRUE(eventually([&] { return remaining_s("PanTilt") < LeasedRobot::kLease_s - 1.5; }));
  robot.keepLeases();
  for (const char* identity : {"PanTilt", "Motors"})
    EXPECT_GT(remaining_s(identity), LeasedRobot::kLease_s - 1.0) << identity;
}

}  // namespace
}  // namespace vismem
