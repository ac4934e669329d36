// Tests C2, C3.
#include <Ice/Ice.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <csignal>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "common/memory_ice/gaze_ice.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "robot_ice/loopback.h"
#include "support/build_paths.h"
#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kTilt_rad = -0.35;

/// The stamps of the last second, every 10 ms, up to `now_us`.
template <typename Sample>
SampleBatch<Sample> samplesUpTo(StampUs now_us, StampUs after_us) {
  SampleBatch<Sample> batch;
  constexpr StampUs kStep_us = 10'000;
  for (StampUs t = std::max<StampUs>(0, now_us - kSecondUs); t <= now_us; t += kStep_us) {
    if (t <= after_us) continue;
    Sample sample;
    sample.stamp_us = t;
    sample.seq = static_cast<std::uint64_t>(t / kStep_us);
    batch.samples.push_back(sample);
  }
  batch.state = batch.samples.empty() ? SourceState::kWaiting : SourceState::kRunning;
  return batch;
}

/// A head that looks ahead and down whatever is commanded, and counts commands.
class FixedHead : public PanTiltUnit {
 public:
  PanTiltLimits limits() const override { return {-2.8, 2.8, -0.6, 0.6, 10.0, 10.0}; }
  PortReply start() override { return PortReply::accepted(); }
  void stop() override {}
  PortReply command(const PanTiltCommand&) override {
    ++commands;
    return PortReply::accepted();
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    auto batch = samplesUpTo<PanTiltSample>(now_us, after_us);
    for (PanTiltSample& sample : batch.samples) sample.tilt_rad = kTilt_rad;
    return batch;
  }
  std::atomic<StampUs> now_us = 0;
  std::atomic<int> commands = 0;
};

class StandingBase : public MobileBase {
 public:
  BaseLimits limits() const override { return {1.0, 1.0, 0.5}; }
  PortReply start() override { return PortReply::accepted(); }
  void stop() override {}
  PortReply setVelocity(double, double) override { return PortReply::accepted(); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return samplesUpTo<OdometrySample>(now_us, after_us);
  }
  std::atomic<StampUs> now_us = 0;
};

/// A bright rectangle on the dark floor, 1.0 to 1.6 m ahead and 0.4 m wide.
cv::Mat picture(const CameraIntrinsics& k) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  const Pose3 T_robot_camera = cameraPose(mount, 0.0, kTilt_rad);
  cv::Mat image(k.height, k.width, CV_8UC3, cv::Scalar(60, 60, 60));
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto p = backProjectToGround(k, T_robot_camera, Eigen::Vector2d(u, v), 50.0);
      if (p && p->x() > 1.0 && p->x() < 1.6 && std::abs(p->y()) < 0.2)
        image.at<cv::Vec3b>(v, u) = {210, 210, 210};
    }
  }
  return image;
}

std::vector<std::string> arguments(int port) {
  const std::string at = ":tcp -h 127.0.0.1 -p " + std::to_string(port);
  return {"--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0",
          "--ActiveVisualMemory.Camera.Proxy=cameraA" + at, "--ActiveVisualMemory.PanTilt.Proxy=PanTilt" + at,
          "--ActiveVisualMemory.Odometry.Proxy=Encoders" + at};
}

TEST(ActiveVisualMemoryProcess, RemembersWhatARemoteCameraShowsAndTurnsTheHead) {
  FixedHead head;
  StandingBase base;
  FrameBroadcaster camera;
  LoopbackServer server;
  const auto pan_tilt = std::make_shared<PanTiltServant>(head);
  const auto odometry = std::make_shared<OdometryServant>(base);
  server.add("cameraA", std::make_shared<CameraServant>(camera, "cameraA"));
  server.add("PanTilt", pan_tilt);
  server.add("Encoders", odometry);

  // The component comes up before its peers and says for whom it waits.
  ComponentProcess component("active_visual_memory", arguments(server.port()));
  ASSERT_TRUE(component.waitUntilReady());
  pan_tilt->start();
  odometry->start();
  server.activate();

  LoopbackClient client;
  VisualMemoryClient memory(client.proxy<avm::VisualMemoryPrx>("VisualMemory", component.port()));
  Frame frame;
  frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  frame.image = picture(frame.intrinsics);
  MemoryResult result;
  std::size_t most = 0;
  const bool remembered = eventually([&] {
    frame.stamp_us += 33'333;
    ++frame.seq;
    head.now_us = base.now_us = frame.stamp_us + 20'000;
    camera.publish(frame);
    const std::uint64_t have = result.update.snapshot ? result.update.snapshot->revision : 0;
    auto next = memory.next(have, 100ms);
    if (next.update.snapshot) result = next;
    if (result.update.snapshot) most = std::max(most, result.update.snapshot->segments.size());
    return result.update.snapshot && result.update.snapshot->segments.size() == 4 && head.commands > 0;
  });
  EXPECT_TRUE(remembered) << "at most " << most << " segments, " << head.commands << " commands\n"
                          << component.error();
  if (remembered) {
    for (const MemorySegment& s : result.update.snapshot->segments) {
      EXPECT_GT(s.odom.middle().x(), 0.95);
      EXPECT_LT(s.odom.middle().x(), 1.65);
      EXPECT_LT(std::abs(s.odom.middle().y()), 0.25);
    }
  }

  const auto report =
      client.proxy<avm::ComponentPrx>("active_visual_memory/component", component.port())->getStatus();
  ASSERT_EQ(report.gauges.size(), 6u) << "camera tilt, a knock, and the CPU";
  const auto pitch = std::find_if(report.gauges.begin(), report.gauges.end(),
                                  [](const auto& gauge) { return gauge.name == "mount pitch error"; });
  ASSERT_NE(pitch, report.gauges.end());
  EXPECT_EQ(pitch->unit, "deg");
  EXPECT_GT(pitch->sigma, 0.0);

  RemoteGaze gaze(client.proxy<avm::GazePrx>("Gaze", component.port()));
  const auto status = gaze.status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->mode, GazeMode::kAttend);
  EXPECT_FALSE(gaze.setMode(GazeMode::kFixate).ok()) << "nothing was fixated so far";
  EXPECT_TRUE(gaze.setMode(GazeMode::kHold).ok());

  RemoteFrameSource view(client.proxy<avm::CameraPrx>("memoryView", component.port()));
  FrameResult shown;
  EXPECT_TRUE(eventually([&] {
    shown = view.next(200ms);
    return shown.frame.has_value();
  }));
  if (shown.frame) {
    EXPECT_EQ(shown.frame->image.size(), cv::Size(320, 240));
  }

  EXPECT_EQ(component.stop(5s), 0) << component.error();
  pan_tilt->stop();
  odometry->stop();
  camera.stop();
}

TEST(ActiveVisualMemoryProcess, SaysForWhomItWaitsAndEndsCleanly) {
  // Port 1 of this host serves nobody.
  ComponentProcess component("active_visual_memory", arguments(1));
  ASSERT_TRUE(component.waitUntilReady());
  EXPECT_TRUE(component.waitForLine("waiting for Camera at cameraA", kPatience)) << component.error();
  EXPECT_TRUE(component.waitForLine("waiting for PanTilt at PanTilt", kPatience)) << component.error();
  EXPECT_TRUE(component.waitForLine("waiting for Odometry at Encoders", kPatience)) << component.error();
  ASSERT_TRUE(component.signal(SIGINT));
  EXPECT_EQ(component.waitForExit(10s), 0) << component.error();
}

TEST(ActiveVisualMemoryProcess, ReportsAllProblemsOfAConfigurationAtOnce) {
  auto wrong = arguments(1);
  wrong.push_back("--ActiveVisualMemory.Attention.ForcedSearch_s=-1");
  wrong.push_back("--ActiveVisualMemory.Gazee.Mode=off");
  ComponentProcess component("active_visual_memory", wrong);
  EXPECT_EQ(component.waitForExit(10s), 2);
  EXPECT_THAT(component.error(), HasSubstr("ActiveVisualMemory.Attention.ForcedSearch_s"));
  EXPECT_THAT(component.error(), HasSubstr("ActiveVisualMemory.Gazee.Mode"));
}

TEST(ActiveVisualMemoryProcess, ShippedConfigurationsAreAccepted) {
  for (const std::string setup : {"sim", "replay", "nao", "files"}) {
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    ComponentProcess component("active_visual_memory",
                               {"--Ice.Config=cfg/" + setup + "/active_visual_memory.cfg",
                                "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0"},
                               options);
    EXPECT_TRUE(component.waitUntilReady()) << setup;
    EXPECT_EQ(component.stop(5s), 0) << component.error();
  }
}

}  // namespace
}  // namespace vismem
