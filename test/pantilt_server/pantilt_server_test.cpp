// The process pantilt_server over Ice: position, velocity, its end, its messages.
// Tests C1, C3.
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "common/drivers/host_clock.h"
#include "common/robot_ice/pantilt_ice.h"
#include "support/build_paths.h"
#include "support/ice_client.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

const std::string kConfig = "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/files/pantilt_server.cfg";
const std::string kEndpoint = "--PanTiltServer.Endpoints=tcp -h 127.0.0.1 -p 0";

TEST(PanTiltServer, TurnsReportsItsStatusAndEndsOnSigterm) {
  ComponentProcess server("pantilt_server", {kConfig, kEndpoint});
  ASSERT_TRUE(server.waitUntilReady());
  IceClient ice;
  RemotePanTiltUnit unit(ice.find<avm::PanTiltPrx>(server, "PanTilt"));
  ASSERT_EQ(unit.start().kind, PortReply::Kind::kAccepted);
  ASSERT_EQ(unit.command({PanTiltCommand::Kind::kPosition, 0.5, -0.3, 0.0, 0.0}).kind,
            PortReply::Kind::kAccepted);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  PanTiltSample last;
  last.stamp_us = kBeforeAllStamps;
  while (std::abs(last.pan_rad - 0.5) > 1e-3 || std::abs(last.tilt_rad + 0.3) > 1e-3) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    const auto batch = unit.samplesSince(last.stamp_us, 200ms);
    if (!batch.samples.empty()) last = batch.samples.back();
  }
  EXPECT_NEAR(toSeconds(last.stamp_us - hostClock_us()), 0.0, 1.0);
  // The crossing point of the axes from the configuration.
  EXPECT_FLOAT_EQ(ice.find<jderobot::Pose3DEncodersPrx>(server, "PanTilt")->getPose3DEncodersData()->z,
                  0.45F);

  const auto status = ice.find<avm::ComponentPrx>(server, "pantilt_server/component")->getStatus();
  EXPECT_EQ(status.state, avm::ComponentState::Running);
  ASSERT_EQ(status.rates.size(), 1U);
  EXPECT_EQ(status.rates[0].name, "samples");
  ASSERT_TRUE(server.signal(SIGTERM));
  EXPECT_EQ(server.waitForExit(kPatience), 0) << server.error();
}

TEST(PanTiltServer, HelpListsTheDriversAndTheKeysOfTheNamedOne) {
  ComponentProcess any("pantilt_server", {"--help"});
  EXPECT_EQ(any.waitForExit(kPatience), 0);
  EXPECT_THAT(any.out(), HasSubstr("PanTiltServer.Driver =    # a driver: " VISMEM_PANTILT_DRIVERS));
  EXPECT_THAT(any.out(), Not(HasSubstr("PanTiltServer.Pan.")));
  for (const std::string& named : {kConfig, std::string("--PanTiltServer.Driver=simulated")}) {
    ComponentProcess one("pantilt_server", {"--help", named});
    EXPECT_EQ(one.waitForExit(kPatience), 0);
    EXPECT_THAT(one.out(), HasSubstr("PanTiltServer.Pan.Minimum_deg = -159   # -180..0"));
  }
}

TEST(PanTiltServer, NamesWhatIsWrongWithItsConfiguration) {
  ComponentProcess values("pantilt_server",
                          {kConfig, kEndpoint, "--PanTiltServer.Pan.Minimum_deg=10",
                           "--PanTiltServer.Position_m=0 0", "--PanTiltServer.Pan.Mximum_deg=1"});
  EXPECT_EQ(values.waitForExit(kPatience), 2);
  EXPECT_THAT(values.error(), HasSubstr("PanTiltServer.Pan.Minimum_deg = 10 (must be -180..0)"));
  EXPECT_THAT(values.error(), HasSubstr("PanTiltServer.Position_m = 0 0 (must be 3 numbers"));
  EXPECT_THAT(values.error(), HasSubstr("unknown key \"PanTiltServer.Pan.Mximum_deg\""));
  ComponentProcess none("pantilt_server", {kEndpoint});
  EXPECT_EQ(none.waitForExit(kPatience), 2);
  EXPECT_THAT(
      none.error(),
      HasSubstr("missing key \"PanTiltServer.Driver\" (must be a driver: " VISMEM_PANTILT_DRIVERS ")"));
}

}  // namespace
}  // namespace vismem
