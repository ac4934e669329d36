/// The real process over Ice: a small recording played to clients of the robot's ports.
#include <Ice/Ice.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/replay_ice.h"
#include "recording/bag_writer.h"
#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/eventually.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ReplayServerTest : public ::testing::Test {
 protected:
  ReplayServerTest() {
    file_ = std::filesystem::temp_directory_path() / ("replay_server_" + std::to_string(::getpid()) + ".bag");
    BagWriter bag(file_.string());
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_footprint", "camera_optical_frame", 0.0, 0.0, 0.4, 0.0);
    for (int i = 0; i < 6; ++i) {
      const std::int64_t stamp_us = 1'000'000 + 100'000 * i;
      bag.image("/camera/image_raw", stamp_us, "mono8", 16, 16, std::vector<std::uint8_t>(256, 7));
      bag.odometry("/odom", stamp_us - 20'000, 0.1 * i, 0.0, 0.0);
      bag.joints("/joint_states", stamp_us - 30'000, {"head_yaw", "head_pitch"}, {0.1 * i, 0.2});
    }
    bag.odometry("/odom", 1'550'000, 0.6, 0.0, 0.0);
    bag.close();
  }
  ~ReplayServerTest() override { std::filesystem::remove(file_); }

  std::unique_ptr<ComponentProcess> serve(std::vector<std::string> arguments = {}) const {
    arguments.push_back("--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/replay/replay_server.cfg");
    arguments.push_back("--ReplayServer.Endpoints=tcp -h 127.0.0.1 -p 0");
    arguments.push_back("--ReplayServer.File=" + file_.string());
    return std::make_unique<ComponentProcess>("replay_server", std::move(arguments));
  }
  template <typename Prx>
  std::shared_ptr<Prx> find(const ComponentProcess& server, const std::string& identity) {
    return Ice::checkedCast<Prx>(
        communicator_->stringToProxy(server.proxy(identity))->ice_invocationTimeout(5000));
  }
  /// Takes frames until the end of the log. @return their stamps.
  static std::vector<StampUs> watch(RemoteFrameSource& camera) {
    std::vector<StampUs> stamps;
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      const FrameResult result = camera.next(milliseconds(500));
      if (result.frame) stamps.push_back(result.frame->stamp_us);
      if (result.state == SourceState::kFinished) break;
    }
    return stamps;
  }

  std::filesystem::path file_;
  Ice::CommunicatorHolder communicator_{Ice::initialize()};
};

TEST_F(ReplayServerTest, PlaysFromItsFirstClientToItsEnd) {
  // A quarter of the speed, so that a busy machine keeps up with every frame.
  const auto server = serve({"--ReplayServer.Rate=0.25"});
  ASSERT_TRUE(server->waitUntilReady());
  RemoteReplay replay(find<avm::ReplayPrx>(*server, "Replay"));
  EXPECT_EQ(replay.status().state, ReplayState::kWaiting);
  EXPECT_EQ(replay.status().first_us, 1'000'000);
  EXPECT_EQ(replay.status().last_us, 1'500'000);

  RemoteFrameSource camera(find<avm::CameraPrx>(*server, "cameraA"));
  RemoteMobileBase base(find<avm::BasePrx>(*server, "Motors"), find<avm::OdometryPrx>(*server, "Encoders"));
  ASSERT_TRUE(camera.start().ok());
  const auto first = camera.next(milliseconds(2000));
  ASSERT_TRUE(first.frame.has_value()) << first.message;
  EXPECT_EQ(first.frame->stamp_us, 1'000'000);
  ASSERT_TRUE(first.frame->T_robot_camera.has_value());
  EXPECT_NEAR(first.frame->T_robot_camera->translation().z(), 0.4, 1e-9);
  EXPECT_THAT(watch(camera), ElementsAre(1'100'000, 1'200'000, 1'300'000, 1'400'000, 1'500'000));
  EXPECT_EQ(replay.status().state, ReplayState::kFinished);
  std::vector<OdometrySample> odometry;
  ASSERT_TRUE(eventually([&] {
    odometry = base.samplesSince(0, milliseconds(2000)).samples;
    return odometry.size() == 7;
  }));
  EXPECT_EQ(odometry.front().stamp_us, 980'000);
  EXPECT_EQ(odometry.back().stamp_us, 1'550'000) << "the last image is covered";
  EXPECT_NEAR(odometry.back().T_odom_robot.x, 0.6, 1e-9);
  EXPECT_EQ(server->stop(kPatience), 0);
}

TEST_F(ReplayServerTest, IsControlledOverItsInterface) {
  const auto server = serve({"--ReplayServer.Start=paused"});
  ASSERT_TRUE(server->waitUntilReady());
  RemoteReplay replay(find<avm::ReplayPrx>(*server, "Replay"));
  RemoteFrameSource camera(find<avm::CameraPrx>(*server, "cameraA"));
  ASSERT_TRUE(camera.start().ok());
  EXPECT_EQ(camera.next(milliseconds(2000)).frame->stamp_us, 1'000'000);
  EXPECT_EQ(replay.seek(99'000'000).kind, PortReply::Kind::kAdjusted);
  EXPECT_TRUE(replay.seek(1'350'000).ok());
  EXPECT_EQ(replay.status().stamp_us, 1'350'000);
  EXPECT_EQ(replay.status().state, ReplayState::kPaused);
  EXPECT_TRUE(replay.setRate(0.5).ok());
  EXPECT_TRUE(replay.play().ok());
  const auto stamps = watch(camera);
  ASSERT_FALSE(stamps.empty());
  EXPECT_EQ(stamps.back(), 1'500'000);

  RemoteMobileBase base(find<avm::BasePrx>(*server, "Motors"), nullptr);
  EXPECT_THAT(base.setVelocity(0.1, 0.0).message, HasSubstr("a recording cannot be moved"));
  RemotePanTiltUnit pan_tilt(find<avm::PanTiltPrx>(*server, "PanTilt"));
  EXPECT_THAT(pan_tilt.command({}).message, HasSubstr("a recording cannot be moved"));
  EXPECT_EQ(server->stop(kPatience), 0);
}

TEST_F(ReplayServerTest, PlaysWhatIsLeftOfABagThatWasCutOff) {
  // The index is the last third of so small a bag.
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) * 7 / 10);
  const auto server = serve({"--ReplayServer.Start=paused"});
  ASSERT_TRUE(server->waitUntilReady());
  const auto replay = find<avm::ReplayPrx>(*server, "Replay");
  const avm::ReplayContents contents = replay->contents();
  EXPECT_GT(contents.images, 0);
  ASSERT_FALSE(contents.notes.empty());
  EXPECT_THAT(contents.notes.front(), HasSubstr("indexed again"));
  EXPECT_THROW(replay->step(0), avm::InvalidArgument);
  EXPECT_THROW(replay->setRange(5, 5), avm::InvalidArgument);
  EXPECT_NO_THROW(replay->step(1));
  EXPECT_EQ(server->stop(kPatience), 0);
  EXPECT_THAT(server->error(), HasSubstr("indexed again"));
}

TEST_F(ReplayServerTest, NamesEachThingThatARecordingLacksInALineOfItsOwn) {
  {
    BagWriter bag(file_.string());
    bag.image("/camera/image_raw", 1'000'000, "mono8", 16, 16, std::vector<std::uint8_t>(256, 7));
    bag.close();
  }
  const auto server = serve();
  EXPECT_EQ(server->waitForExit(kPatience), 2);
  EXPECT_THAT(server->error(), AllOf(HasSubstr("\n" + file_.string() + ": no calibration of the camera"),
                                     HasSubstr("\n" + file_.string() + ": no odometry")));
}

TEST_F(ReplayServerTest, SaysWhatIsWrongWithItsRecordingAndEnds) {
  std::filesystem::resize_file(file_, 4200);
  const auto server = serve();
  EXPECT_EQ(server->waitForExit(kPatience), 2);
  EXPECT_THAT(server->error(), AllOf(HasSubstr(file_.string()), HasSubstr("index is missing or damaged")));
  const ComponentProcess unset("replay_server", {"--ReplayServer.Rte=2", "--ReplayServer.Start=never"});
  EXPECT_EQ(unset.waitForExit(kPatience), 2);
  EXPECT_THAT(unset.error(), AllOf(HasSubstr("ReplayServer.File"), HasSubstr("ReplayServer.Rte"),
                                   HasSubstr("ReplayServer.Start = never")));
}

}  // namespace
}  // namespace vismem
