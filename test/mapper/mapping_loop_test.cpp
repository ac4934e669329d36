// Recording a live drive: images and updates come on their own ways. Tests B6, C3.
#include "mapper/app/mapping_loop.h"

#include <gmock/gmock.h>

#include <deque>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "common/process/log.h"
#include "support/eventually.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

Frame frameAt(StampUs stamp_us) {
  Frame frame;
  frame.stamp_us = stamp_us;
  frame.seq = static_cast<std::uint64_t>(stamp_us);
  frame.intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
  frame.image = cv::Mat(240, 320, CV_8UC3, cv::Scalar(45, 45, 45));
  return frame;
}

/// Delivers what it was given, once.
class Images : public FrameSource {
 public:
  FrameCapabilities capabilities() const override { return {}; }
  PortReply configure(const FrameRequest&) override { return PortReply::accepted(); }
  PortReply start() override { return PortReply::accepted(); }
  FrameResult next(milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, timeout, [&] { return !frames_.empty(); });
    if (frames_.empty()) return {};
    Frame frame = std::move(frames_.front());
    frames_.pop_front();
    return {SourceState::kRunning, std::move(frame), ""};
  }
  void stop() override {}
  void give(Frame frame) {
    {
      const std::lock_guard lock(mutex_);
      frames_.push_back(std::move(frame));
    }
    came_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Frame> frames_;
};

class Memory : public VisualMemorySource {
 public:
  MemoryResult next(std::uint64_t after_revision, milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, timeout, [&] {
      return ended_ || (update_.snapshot && update_.snapshot->revision != after_revision);
    });
    if (update_.snapshot && update_.snapshot->revision != after_revision)
      return {SourceState::kRunning, update_, ""};
    return {ended_ ? SourceState::kFinished : SourceState::kWaiting, {}, ended_ ? "drive.bag" : "not due"};
  }
  /// The robot stands at x.
  void publish(StampUs stamp_us, double x) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    auto analysis = std::make_shared<ImageAnalysis>();
    snapshot->stamp_us = analysis->stamp_us = stamp_us;
    snapshot->revision = ++revision_;
    analysis->frame_seq = static_cast<std::uint64_t>(stamp_us);
    snapshot->T_odom_robot = analysis->T_odom_robot = {x, 0.0, 0.0};
    analysis->intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
    CameraMount mount;
    mount.T_robot_pantilt.translation().z() = 0.5;
    analysis->T_robot_camera = cameraPose(mount, 0.0, degToRad(-30.0));
    {
      const std::lock_guard lock(mutex_);
      update_ = {snapshot, analysis};
    }
    came_.notify_all();
  }
  void end() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    came_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  MemoryUpdate update_;
  std::uint64_t revision_ = 0;
  bool ended_ = false;
};

class MappingLoopTest : public testing::Test {
 protected:
  void start(int most_keyframes = 1000) {
    MappingLoop::Params params;
    params.range_m = 5.0;
    params.most_keyframes = most_keyframes;
    loop_ = std::make_unique<MappingLoop>(params, memory_, images_, status_);
    loop_->start([](const DriveProgress&) {}, [](std::exception_ptr) { FAIL() << "a thread failed"; });
  }
  /// An image and what the memory made of it. @return whether it became the keyframe of that number.
  bool step(double x, int keyframes) {
    stamp_us_ += kSecondUs;
    images_.give(frameAt(stamp_us_));
    memory_.publish(stamp_us_, x);
    return eventually([&] { return loop_->progress().keyframes == keyframes; });
  }

  Logger log_{"test"};
  StatusBoard status_{"test", "0", log_};
  Images images_;
  Memory memory_;
  StampUs stamp_us_ = 0;
  std::unique_ptr<MappingLoop> loop_;
};

TEST_F(MappingLoopTest, AnUpdateWaitsForItsImage) {
  start();
  memory_.publish(kSecondUs, 0.0);  // the image is still on its way
  images_.give(frameAt(kSecondUs));
  EXPECT_TRUE(eventually([&] { return loop_->progress().keyframes == 1; }));
}

TEST_F(MappingLoopTest, AnUpdateWithoutItsImageIsNoKeyframeButTheDriveGoesOn) {
  start();
  ASSERT_TRUE(step(0.0, 1));
  images_.give(frameAt(stamp_us_ + 3 * kSecondUs));
  memory_.publish(stamp_us_ + 2 * kSecondUs, 0.2);  // its image was missed
  memory_.publish(stamp_us_ + 3 * kSecondUs, 0.4);
  ASSERT_TRUE(eventually([&] { return loop_->progress().keyframes == 2; }));
  EXPECT_NEAR(loop_->progress().way_m, 0.4, 1e-9);
}

TEST_F(MappingLoopTest, AJumpOfTheOdometryEndsTheDriveAndARestartBeginsAnew) {
  start();
  ASSERT_TRUE(step(0.0, 1));
  stamp_us_ += kSecondUs;
  images_.give(frameAt(stamp_us_));
  memory_.publish(stamp_us_, 9.0);
  EXPECT_TRUE(eventually([&] { return loop_->drive().isBroken(); }));
  EXPECT_TRUE(eventually([&] { return loop_->progress().message.find("jumped") != std::string::npos; }));
  EXPECT_EQ(loop_->drive().record().keyframes.size(), 1U);
  loop_->restart();
  ASSERT_TRUE(step(9.1, 1));
  EXPECT_EQ(loop_->progress().message, "");
}

TEST_F(MappingLoopTest, ADriveDoesNotGrowForEver) {
  start(2);
  ASSERT_TRUE(step(0.0, 1));
  ASSERT_TRUE(step(0.2, 2));
  stamp_us_ += kSecondUs;
  images_.give(frameAt(stamp_us_));
  memory_.publish(stamp_us_, 0.4);
  EXPECT_TRUE(eventually([&] { return loop_->progress().message.find("as long as") != std::string::npos; }));
  EXPECT_EQ(loop_->progress().keyframes, 2);
}

TEST_F(MappingLoopTest, ARecordingThatEndsIsSaid) {
  start();
  ASSERT_TRUE(step(0.0, 1));
  memory_.end();
  EXPECT_TRUE(eventually([&] { return loop_->progress().finished; }));
  EXPECT_THAT(loop_->progress().message, HasSubstr("drive.bag"));
}

TEST(RecentFrames, OnlyTheNewestAreKept) {
  RecentFrames frames(2);
  for (StampUs stamp_us : {1, 2, 3}) frames.add(frameAt(stamp_us));
  EXPECT_TRUE(frames.at(1, milliseconds(0)).image.empty());
  EXPECT_FALSE(frames.at(2, milliseconds(0)).image.empty());
  EXPECT_TRUE(frames.at(4, milliseconds(1)).image.empty());
}

}  // namespace
}  // namespace vismem
