// A camera over a real connection: long-polls, formats, slow and lost peers.
// Tests C3, C4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <future>

#include "common/robot_ice/camera_ice.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Frame frameWith(std::uint64_t seq, int brightness = 100) {
  Frame frame;
  frame.seq = seq;
  frame.stamp_us = static_cast<StampUs>(seq) * 1000;
  frame.image = cv::Mat(8, 16, CV_8UC3, cv::Scalar::all(brightness));
  frame.intrinsics = intrinsicsFromFieldOfView(16, 8, 1.0);
  return frame;
}

class CameraLoopback : public ::testing::Test {
 protected:
  CameraLoopback() { serve(0); }
  ~CameraLoopback() override { broadcaster->stop(); }

  void serve(int at_port) {
    broadcaster = std::make_unique<FrameBroadcaster>();
    server = std::make_unique<LoopbackServer>(at_port);
    server->add("cameraA", std::make_shared<CameraServant>(*broadcaster, "cameraA"));
    server->activate();
    port = server->port();
  }
  void endServer() {
    server->deactivate();
    broadcaster->stop();
    server.reset();
  }
  std::shared_ptr<avm::CameraPrx> proxy() { return client.proxy<avm::CameraPrx>("cameraA", port); }

  std::unique_ptr<FrameBroadcaster> broadcaster;
  std::unique_ptr<LoopbackServer> server;
  int port = 0;
  LoopbackClient client;
};

TEST_F(CameraLoopback, GivesTheNewestFrameOnce) {
  broadcaster->publish(frameWith(1));
  broadcaster->publish(frameWith(2));
  RemoteFrameSource source(proxy());
  const FrameResult first = source.next(2s);
  ASSERT_EQ(first.state, SourceState::kRunning) << first.message;
  EXPECT_EQ(first.frame->seq, 2U);
  EXPECT_EQ(source.next(20ms).state, SourceState::kWaiting);
  // The request that is still pending brings the next one.
  broadcaster->publish(frameWith(3));
  const FrameResult next = source.next(2s);
  ASSERT_TRUE(next.frame) << next.message;
  EXPECT_EQ(next.frame->seq, 3U);
}

TEST_F(CameraLoopback, AnswersWithinASecondWithoutAFrame) {
  const auto result = proxy()->getNext("RGB8", -1);
  EXPECT_EQ(result.state, avm::SourceState::Waiting);
  EXPECT_EQ(result.message, "no frame yet");
}

TEST_F(CameraLoopback, ReportsTheEndOfALog) {
  broadcaster->publish(frameWith(1));
  RemoteFrameSource source(proxy());
  ASSERT_TRUE(source.next(2s).frame);
  EXPECT_FALSE(source.next(10ms).frame);
  broadcaster->setState(SourceState::kFinished, "end of log");
  EXPECT_EQ(source.next(2s).state, SourceState::kFinished);
}

TEST_F(CameraLoopback, OneEncodingServesAllClients) {
  broadcaster->publish(frameWith(1));
  LoopbackClient other;
  EXPECT_EQ(proxy()->getNext("JPEG", -1).image.format, "JPEG");
  EXPECT_EQ(other.proxy<avm::CameraPrx>("cameraA", port)->getNext("JPEG", -1).image.format, "JPEG");
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 1);
}

TEST_F(CameraLoopback, ManyClientsAtOnceShareOneEncoding) {
  std::vector<std::future<Ice::Long>> answers;
  for (int i = 0; i < 10; ++i) {
    auto answer = std::make_shared<std::promise<Ice::Long>>();
    answers.push_back(answer->get_future());
    proxy()->getNextAsync("JPEG", -1,
                          [answer](avm::FrameResult result) { answer->set_value(result.image.seq); });
  }
  ASSERT_TRUE(eventually([&] { return broadcaster->latest().waiting() == 10; }));
  broadcaster->publish(frameWith(4));
  for (auto& answer : answers) EXPECT_EQ(answer.get(), 4);
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 1);
}

TEST_F(CameraLoopback, MakesAheadWhatAClientThatDoesNotWaitAskedFor) {
  broadcaster->publish(frameWith(1));
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 0);
  EXPECT_EQ(proxy()->getImageData("GRAY8")->description->format, "GRAY8");
  broadcaster->publish(frameWith(2));
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 1);
  EXPECT_EQ(proxy()->getImageData("GRAY8")->description->format, "GRAY8");
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 1);
  // This ends without further requests.
  for (int i = 3; i < 40; ++i) broadcaster->publish(frameWith(i));
  EXPECT_EQ(broadcaster->latest().latest()->encodings(), 0);
}

TEST_F(CameraLoopback, PassesOverAPictureThatCannotBeDecoded) {
  std::promise<Ice::Long> answer;
  proxy()->getNextAsync("RGB8", -1, [&](avm::FrameResult result) { answer.set_value(result.image.seq); });
  ASSERT_TRUE(eventually([&] { return broadcaster->latest().waiting() == 1; }));
  Frame broken;
  broken.seq = 1;
  broken.native = std::make_shared<NativeImage>(NativeImage{NativeFormat::kYuyv, 16, 8, 0, {1, 2, 3}});
  broadcaster->publish(std::move(broken));
  ASSERT_TRUE(eventually([&] { return broadcaster->latest().waiting() == 1; }));
  EXPECT_THROW(proxy()->getImageData("RGB8"), jderobot::HardwareFailedException);
  broadcaster->publish(frameWith(2));
  EXPECT_EQ(answer.get_future().get(), 2);
}

TEST_F(CameraLoopback, AwaitsTheDeadlineWhenOnlyBrokenPicturesCome) {
  Frame broken;
  broken.seq = 1;
  broken.native = std::make_shared<NativeImage>(NativeImage{NativeFormat::kYuyv, 16, 8, 0, {1, 2, 3}});
  broadcaster->publish(std::move(broken));
  const auto began = std::chrono::steady_clock::now();
  const auto result = proxy()->getNext("RGB8", -1);
  EXPECT_EQ(result.state, avm::SourceState::Waiting);
  EXPECT_GE(std::chrono::steady_clock::now() - began, 900ms) << "a client would ask again at once";
}

TEST_F(CameraLoopback, DescribesTheNewestImageWithItsMd5Sum) {
  const auto camera = Ice::uncheckedCast<jderobot::CameraPrx>(client.proxy<Ice::ObjectPrx>("cameraA", port));
  EXPECT_EQ(camera->getImageDescription()->md5sum, "");
  Frame frame = frameWith(5);
  // Looks ahead from 0.5 m, turned by 0.3 rad about its axis.
  frame.T_robot_camera = cameraPose(CameraMount{}, 0, 0) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
  frame.T_robot_camera->translation() = Eigen::Vector3d(0, 0, 0.5);
  broadcaster->publish(std::move(frame));
  EXPECT_EQ(camera->getImageDescription()->md5sum, camera->getImageData("RGB8")->description->md5sum);
  EXPECT_EQ(camera->getImageDescription()->md5sum.size(), 32U);
  EXPECT_NEAR(camera->getCameraDescription()->roll, 0.3, 1e-6);
  EXPECT_NEAR(camera->getCameraDescription()->foax, 1.0, 1e-6);
  EXPECT_NEAR(camera->getCameraDescription()->posz, 0.5, 1e-6);
}

TEST_F(CameraLoopback, AWaitingClientDoesNotDelayAnother) {
  broadcaster->publish(frameWith(1));
  std::promise<Ice::Long> waiting;
  proxy()->getNextAsync("RGB8", 1, [&](avm::FrameResult result) { waiting.set_value(result.image.seq); });
  ASSERT_TRUE(eventually([&] { return broadcaster->latest().waiting() == 1; }));
  LoopbackClient other;
  // The server has one dispatch thread: were it blocked, this would wait for the other's second.
  EXPECT_EQ(other.proxy<avm::CameraPrx>("cameraA", port)->getNext("RGB8", -1).image.seq, 1);
  EXPECT_EQ(broadcaster->latest().waiting(), 1U);
  broadcaster->publish(frameWith(2));
  EXPECT_EQ(waiting.get_future().get(), 2);
}

TEST_F(CameraLoopback, RefusesUnknownFormatsWithTheKnownOnes) {
  broadcaster->publish(frameWith(1));
  try {
    proxy()->getNext("BGR8", -1);
    FAIL() << "must throw";
  } catch (const avm::InvalidArgument& error) {
    EXPECT_EQ(error.reason, "unknown format \"BGR8\" (known: RGB8, GRAY8, JPEG, YUY2)");
  }
  try {
    proxy()->getImageData("BGR8");
    FAIL() << "must throw";
  } catch (const jderobot::DataNotExistException& error) {
    EXPECT_THAT(error.what, HasSubstr("known: RGB8, GRAY8, JPEG, YUY2"));
  }
}

TEST_F(CameraLoopback, ServesJdeRobotsClients) {
  const auto camera = Ice::checkedCast<jderobot::CameraPrx>(client.proxy<Ice::ObjectPrx>("cameraA", port));
  ASSERT_TRUE(camera);
  EXPECT_THAT(camera->getImageFormat(), ElementsAre("RGB8", "GRAY8", "JPEG", "YUY2"));
  EXPECT_THROW(camera->getImageData("RGB8"), jderobot::HardwareFailedException);
  broadcaster->publish(frameWith(5, 77));
  const auto image = camera->getImageData("GRAY8");
  EXPECT_EQ(image->description->width, 16);
  EXPECT_EQ(image->description->height, 8);
  EXPECT_EQ(image->pixelData.size(), 128U);
  EXPECT_EQ(image->pixelData[0], 77);
  EXPECT_EQ(image->description->md5sum.size(), 32U);
  EXPECT_EQ(image->timeStamp.useconds, 5000);
  EXPECT_EQ(camera->getImageDescription()->size, 16 * 8 * 3);
  const auto description = camera->getCameraDescription();
  EXPECT_EQ(description->name, "cameraA");
  EXPECT_FLOAT_EQ(description->u0, 7.5F);
  EXPECT_EQ(camera->setCameraDescription(description), -1);
  EXPECT_EQ(camera->startCameraStreaming(), "");
}

TEST_F(CameraLoopback, ClientComesBackAfterARestartWithLowerNumbers) {
  broadcaster->publish(frameWith(500));
  RemoteFrameSource source(proxy());
  ASSERT_EQ(source.next(2s).frame->seq, 500U);
  endServer();
  FrameResult away = source.next(300ms);
  EXPECT_EQ(away.state, SourceState::kWaiting);
  ASSERT_TRUE(eventually([&] { return source.next(50ms).message.find("refused") != std::string::npos; }));
  serve(port);
  broadcaster->publish(frameWith(3));
  std::optional<Frame> frame;
  ASSERT_TRUE(eventually([&] {
    frame = source.next(500ms).frame;
    return frame.has_value();
  }));
  EXPECT_EQ(frame->seq, 3U);
}

TEST_F(CameraLoopback, StopAnswersWaitingRequests) {
  broadcaster->publish(frameWith(1));
  std::promise<avm::SourceState> state;
  proxy()->getNextAsync("RGB8", 1, [&](avm::FrameResult result) { state.set_value(result.state); });
  ASSERT_TRUE(eventually([&] { return broadcaster->latest().waiting() == 1; }));
  broadcaster->stop();
  EXPECT_EQ(broadcaster->latest().waiting(), 0U);
  EXPECT_EQ(state.get_future().get(), avm::SourceState::Waiting);
}

TEST_F(CameraLoopback, ReportsTheLinkAndNeverThrows) {
  std::string failure = "not reported";
  RemoteFrameSource source(client.proxy<avm::CameraPrx>("nobody", port), FrameFormat::kRgb8,
                           [&](const std::string& why) { failure = why; });
  EXPECT_THAT(source.start().message, HasSubstr("no object"));
  EXPECT_EQ(source.next(500ms).state, SourceState::kWaiting);
  EXPECT_THAT(failure, HasSubstr("no object"));
  RemoteFrameSource none(nullptr);
  EXPECT_EQ(none.start().kind, PortReply::Kind::kRejected);
  EXPECT_EQ(none.next(1ms).state, SourceState::kWaiting);
}

/// A source that gives frames by number, then the end.
class CountingSource : public FrameSource {
 public:
  FrameCapabilities capabilities() const override { return {"counting", 16, 8, 30.0, false}; }
  PortReply configure(const FrameRequest&) override { return PortReply::accepted(); }
  PortReply start() override { return PortReply::accepted(); }
  FrameResult next(std::chrono::milliseconds) override {
    if (seq_ == 3) return {SourceState::kFinished, std::nullopt, "end of log"};
    return {SourceState::kRunning, frameWith(++seq_), {}};
  }
  void stop() override {}

 private:
  std::uint64_t seq_ = 0;
};

TEST_F(CameraLoopback, PumpsASourceToItsEnd) {
  CountingSource counting;
  broadcaster->start(counting);
  RemoteFrameSource source(proxy());
  EXPECT_EQ(source.start().kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(source.capabilities().name, "counting");
  EXPECT_EQ(source.configure({16, 8, 0}).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(source.configure({640, 480, 0}).kind, PortReply::Kind::kAdjusted);
  std::uint64_t last = 0;
  ASSERT_TRUE(eventually([&] {
    const FrameResult result = source.next(2s);
    if (result.frame) last = result.frame->seq;
    return result.state == SourceState::kFinished;
  }));
  EXPECT_EQ(last, 3U);
  EXPECT_EQ(broadcaster->published(), 3U);
  broadcaster->stop();
}

}  // namespace
}  // namespace vismem
