#include "replay_server/app/log_player.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "recording/bag_writer.h"
#include "replay_server/core/stepped_log.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr milliseconds kNoWait{0};

/// Time advances on request of the test, and to the end of each wait.
class FakeClock : public PacingClock {
 public:
  StampUs now() const override { return now_us; }
  void waitUntil(std::unique_lock<std::mutex>&, std::condition_variable&, StampUs until_us) override {
    now_us = std::max(now_us, until_us);
  }
  StampUs now_us = 1'000;
};

/// Images at 1.0, 1.1, 1.5 s; odometry at 0.95, 1.05, 1.3, 1.6 s; joints as wanted.
class LogPlayerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() / ("log_player_" + std::to_string(::getpid()) + ".bag");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  RobotLog log(bool joints = true) const {
    BagWriter bag(file_.string());
    const std::vector<std::uint8_t> pixels(256, 7);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_footprint", "camera_optical_frame", 0.0, 0.0, 0.4, 0.0);
    for (const std::int64_t stamp_us : {1'000'000, 1'100'000, 1'500'000}) {
      bag.image("/camera/image_raw", stamp_us, "mono8", 16, 16, pixels);
    }
    for (const std::int64_t stamp_us : {900'000, 950'000, 1'050'000, 1'300'000, 1'600'000, 1'700'000}) {
      bag.odometry("/odom", stamp_us, 1e-6 * static_cast<double>(stamp_us), 0.0, 0.0);
      if (joints) bag.joints("/joint_states", stamp_us + 1'000, {"pan", "tilt"}, {0.1, 0.2});
    }
    bag.close();
    return RobotLog::open(file_.string());
  }

  template <typename Sample>
  static std::vector<StampUs> stamps(const SampleBatch<Sample>& batch) {
    std::vector<StampUs> result;
    for (const Sample& sample : batch.samples) result.push_back(sample.stamp_us);
    return result;
  }

  std::filesystem::path file_;
  FakeClock clock_;
};

TEST_F(LogPlayerTest, WaitsForItsFirstConsumerAndMissesNothing) {
  LogPlayer player(log(), {}, clock_);
  clock_.now_us += 10 * kSecondUs;
  FrameResult result = player.camera().next(kNoWait);
  EXPECT_EQ(result.state, SourceState::kWaiting);
  EXPECT_THAT(result.message, HasSubstr("waits for a client"));
  EXPECT_TRUE(player.base().samplesSince(0, kNoWait).samples.empty());
  player.consumerArrived();
  result = player.camera().next(kNoWait);
  ASSERT_EQ(result.state, SourceState::kRunning);
  EXPECT_EQ(result.frame->stamp_us, 1'000'000);
}

TEST_F(LogPlayerTest, GivesEachFrameWhenItsStampIsReached) {
  LogPlayer player(log(), {2.0, false, ReplayState::kPlaying}, clock_);
  const StampUs begin_us = clock_.now_us;
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'000'000);
  EXPECT_EQ(player.camera().next(kNoWait).state, SourceState::kWaiting);
  // The wait of one second is cut short: at twice the speed 0.1 s of the log take 0.05 s.
  const FrameResult second = player.camera().next(milliseconds(1000));
  EXPECT_EQ(second.frame->stamp_us, 1'100'000);
  EXPECT_EQ(second.frame->seq, 1u);
  EXPECT_EQ(clock_.now_us - begin_us, 50'000);
  EXPECT_EQ(player.camera().next(milliseconds(1000)).frame->stamp_us, 1'500'000);
  EXPECT_EQ(player.camera().next(milliseconds(1000)).state, SourceState::kFinished);
  EXPECT_EQ(player.status().state, ReplayState::kFinished);
}

TEST_F(LogPlayerTest, GivesSamplesAtTheirOwnStamps) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPlaying}, clock_);
  EXPECT_THAT(stamps(player.base().samplesSince(0, kNoWait)), ElementsAre(950'000))
      << "the last before the first image, which needs it";
  EXPECT_THAT(stamps(player.panTilt().samplesSince(0, kNoWait)), ElementsAre(951'000));
  clock_.now_us += 400'000;
  EXPECT_THAT(stamps(player.base().samplesSince(950'000, kNoWait)), ElementsAre(1'050'000, 1'300'000));
  EXPECT_TRUE(player.base().samplesSince(1'300'000, kNoWait).samples.empty());
}

TEST_F(LogPlayerTest, EndsWhenTheLastImageIsCovered) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPlaying}, clock_);
  clock_.now_us += 520'000;
  EXPECT_EQ(player.status().state, ReplayState::kPlaying) << "odometry at 1.6 s is still to come";
  clock_.now_us += 1'000'000;
  EXPECT_EQ(player.status().state, ReplayState::kFinished);
  EXPECT_EQ(player.status().last_us, 1'500'000);
  EXPECT_THAT(stamps(player.base().samplesSince(1'300'000, kNoWait)), ElementsAre(1'600'000));
  EXPECT_EQ(player.base().samplesSince(1'600'000, kNoWait).state, SourceState::kFinished);
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'500'000) << "the newest wins";
  EXPECT_EQ(player.camera().next(kNoWait).state, SourceState::kFinished);
  EXPECT_FALSE(player.pause().ok());
}

TEST_F(LogPlayerTest, SeeksBackAndForth) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPlaying}, clock_);
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'000'000);
  EXPECT_TRUE(player.seek(1'200'000).ok());
  const FrameResult shown = player.camera().next(kNoWait);
  EXPECT_EQ(shown.frame->stamp_us, 1'100'000) << "the one at or before";
  EXPECT_GT(shown.frame->seq, 0u);
  EXPECT_THAT(stamps(player.base().samplesSince(0, kNoWait)), ElementsAre(1'050'000));
  const PortReply clamped = player.seek(0);
  EXPECT_EQ(clamped.kind, PortReply::Kind::kAdjusted);
  const FrameResult again = player.camera().next(kNoWait);
  EXPECT_EQ(again.frame->stamp_us, 1'000'000);
  EXPECT_GT(again.frame->seq, shown.frame->seq) << "sequence numbers go on";
}

TEST_F(LogPlayerTest, AShortJumpBackGivesItsSamplesAgain) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPaused}, clock_);
  player.seek(1'350'000);
  EXPECT_THAT(stamps(player.base().samplesSince(0, kNoWait)), ElementsAre(1'050'000, 1'300'000));
  player.seek(1'100'000);
  // The reader asks from the newest that it has, which lies ahead now.
  EXPECT_THAT(stamps(player.base().samplesSince(1'300'000, kNoWait)), ElementsAre(1'050'000));
  EXPECT_TRUE(player.base().samplesSince(1'050'000, kNoWait).samples.empty()) << "once";
  player.seek(1'350'000);
  EXPECT_THAT(stamps(player.base().samplesSince(1'050'000, kNoWait)), ElementsAre(1'050'000, 1'300'000));
}

TEST_F(LogPlayerTest, PausesAndRejectsWhatARecordingCannotDo) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPlaying}, clock_);
  player.pause();
  clock_.now_us += 5 * kSecondUs;
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'000'000);
  EXPECT_EQ(player.camera().next(kNoWait).message, "the replay is paused");
  EXPECT_THAT(player.base().setVelocity(0.1, 0.0).message, HasSubstr("a recording cannot be moved"));
  EXPECT_TRUE(player.panTilt().command({}).ok());
  EXPECT_FALSE(player.setRate(0.0).ok());
  EXPECT_TRUE(player.setRate(1000.0).ok());
}

TEST_F(LogPlayerTest, LoopsWithSequenceNumbersThatGoOn) {
  LogPlayer player(log(), {1.0, true, ReplayState::kPlaying}, clock_);
  std::vector<StampUs> seen;
  std::vector<std::uint64_t> seqs;
  for (int i = 0; i < 5; ++i) {
    const FrameResult result = player.camera().next(milliseconds(1000));
    ASSERT_TRUE(result.frame.has_value()) << result.message;
    seen.push_back(result.frame->stamp_us);
    seqs.push_back(result.frame->seq);
  }
  EXPECT_THAT(seen, ElementsAre(1'000'000, 1'100'000, 1'500'000, 1'000'000, 1'100'000));
  EXPECT_THAT(seqs, ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(LogPlayerTest, StepsFromImageToImage) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPlaying}, clock_);
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'000'000);
  EXPECT_TRUE(player.step(1).ok());
  EXPECT_EQ(player.status().state, ReplayState::kPaused);
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'100'000);
  clock_.now_us += kSecondUs;
  EXPECT_EQ(player.camera().next(kNoWait).state, SourceState::kWaiting) << "it stays paused";
  EXPECT_TRUE(player.step(1).ok());
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'500'000);
  EXPECT_EQ(player.step(1).kind, PortReply::Kind::kAdjusted);
  EXPECT_TRUE(player.step(-2).ok());
  EXPECT_EQ(player.camera().next(kNoWait).frame->stamp_us, 1'000'000);
}

TEST_F(LogPlayerTest, PlaysInPieces) {
  LogPlayer player(log(), {1.0, false, ReplayState::kPaused}, clock_);
  EXPECT_TRUE(player.setPlayLength(150'000).ok());
  player.play();
  clock_.now_us += kSecondUs;
  EXPECT_EQ(player.status().state, ReplayState::kPaused);
  EXPECT_EQ(player.status().stamp_us, 1'150'000);
  player.play();
  clock_.now_us += kSecondUs;
  EXPECT_EQ(player.status().stamp_us, 1'300'000);
  EXPECT_TRUE(player.setPlayLength(0).ok());
  player.play();
  clock_.now_us += 2 * kSecondUs;
  EXPECT_EQ(player.status().state, ReplayState::kFinished);
}

TEST_F(LogPlayerTest, LoopsOverARange) {
  LogPlayer player(log(), {1.0, true, ReplayState::kPlaying}, clock_);
  EXPECT_FALSE(player.setRange(2'000'000, 3'000'000).ok());
  EXPECT_TRUE(player.setRange(1'050'000, 1'200'000).ok());
  EXPECT_EQ(player.contents().begin_us, 1'050'000);
  std::vector<StampUs> seen;
  for (int i = 0; i < 4; ++i) {
    const FrameResult result = player.camera().next(milliseconds(1000));
    ASSERT_TRUE(result.frame.has_value()) << result.message;
    seen.push_back(result.frame->stamp_us);
  }
  EXPECT_THAT(seen, ElementsAre(1'000'000, 1'100'000, 1'000'000, 1'100'000))
      << "the one before the range is shown first";
  EXPECT_EQ(player.seek(1'500'000).kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(player.status().stamp_us, 1'200'000);
}

TEST_F(LogPlayerTest, SaysWhatTheLogHolds) {
  LogPlayer player(log(), {}, clock_);
  const ReplayContents contents = player.contents();
  EXPECT_EQ(contents.images, 3u);
  ASSERT_EQ(contents.topics.size(), 5u);
  EXPECT_EQ(contents.topics[1].name, "/camera/image_raw");
  EXPECT_EQ(contents.topics[1].messages, 3u);
}

TEST_F(LogPlayerTest, HasNoJointsWhereTheLogHasNone) {
  LogPlayer player(log(false), {1.0, false, ReplayState::kPlaying}, clock_);
  clock_.now_us += kSecondUs;
  const auto batch = player.panTilt().samplesSince(0, milliseconds(100));
  EXPECT_TRUE(batch.samples.empty());
  EXPECT_THAT(batch.message, HasSubstr("has none"));
}

TEST_F(LogPlayerTest, ShutDownEndsAWait) {
  SteadyPacingClock steady;
  LogPlayer player(log(), {}, steady);
  FrameResult result;
  std::thread waiter([&] { result = player.camera().next(std::chrono::minutes(10)); });
  player.shutDown();
  waiter.join();
  EXPECT_EQ(result.state, SourceState::kWaiting);
}

TEST_F(LogPlayerTest, SteppedLogCoversEachFrameWithSamples) {
  SteppedLog robot(log());
  ASSERT_TRUE(robot.advanceToNextFrame());
  EXPECT_EQ(robot.camera().next(kNoWait).frame->stamp_us, 1'000'000);
  EXPECT_EQ(robot.camera().next(kNoWait).state, SourceState::kWaiting) << "a frame is given once";
  EXPECT_THAT(stamps(robot.base().samplesSince(0, kNoWait)), ElementsAre(900'000, 950'000, 1'050'000));
  ASSERT_TRUE(robot.advanceToNextFrame());
  EXPECT_THAT(stamps(robot.base().samplesSince(1'050'000, kNoWait)), ElementsAre(1'300'000));
  ASSERT_TRUE(robot.advanceToNextFrame());
  EXPECT_THAT(stamps(robot.base().samplesSince(1'300'000, kNoWait)), ElementsAre(1'600'000));
  EXPECT_FALSE(robot.advanceToNextFrame());
  EXPECT_EQ(robot.camera().next(kNoWait).state, SourceState::kFinished);
  EXPECT_THAT(robot.panTilt().command({}).message, HasSubstr("ignored"));
}

}  // namespace
}  // namespace vismem
