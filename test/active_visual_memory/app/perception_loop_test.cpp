// Tests M7, A6.
#include "active_visual_memory/app/perception_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <sstream>

#include "common/geometry/angles.h"
#include "common/process/log.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kPatience = 20s;
constexpr StampUs kStep_us = 20'000;

/// A robot whose time the test moves. It answers as the clients of remote servers do: what is newer than
/// asked for, or all that it holds when its time went back.
class Robot {
 public:
  class Camera final : public FrameSource {
   public:
    explicit Camera(Robot& robot) : robot_(robot) {}
    FrameCapabilities capabilities() const override { return {"test", 160, 120, 0.0, true}; }
    PortReply configure(const FrameRequest&) override { return PortReply::accepted(); }
    PortReply start() override { return PortReply::accepted(); }
    void stop() override {}
    FrameResult next(std::chrono::milliseconds timeout) override {
      std::unique_lock lock(robot_.mutex_);
      robot_.changed_.wait_for(lock, timeout, [&] { return robot_.seq_ != given_; });
      if (robot_.fail_) throw std::runtime_error("the camera's thread has thrown");
      if (robot_.seq_ == given_) return {SourceState::kWaiting, std::nullopt, "the camera is silent"};
      given_ = robot_.seq_;
      Frame frame;
      frame.stamp_us = robot_.now_us_;
      frame.seq = robot_.seq_;
      frame.image = cv::Mat(120, 160, CV_8UC3, cv::Scalar(60, 60, 60));
      frame.intrinsics = intrinsicsFromFieldOfView(160, 120, 1.0);
      frame.T_robot_camera = poseFromXyzRpy(0, 0, 0.45, -2.0, 0, -1.5);
      return {SourceState::kRunning, std::move(frame), ""};
    }

   private:
    Robot& robot_;
    std::uint64_t given_ = 0;
  };

  class Base final : public MobileBase {
   public:
    explicit Base(Robot& robot) : robot_(robot) {}
    BaseLimits limits() const override { return {}; }
    PortReply start() override { return PortReply::accepted(); }
    void stop() override {}
    PortReply setVelocity(double, double) override { return PortReply::accepted(); }
    SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
      return robot_.samplesSince<OdometrySample>(after_us, timeout);
    }

   private:
    Robot& robot_;
  };

  /// It looks ahead, whatever is commanded.
  class Head final : public PanTiltUnit {
   public:
    explicit Head(Robot& robot) : robot_(robot) {}
    PanTiltLimits limits() const override { return {}; }
    PortReply start() override { return PortReply::accepted(); }
    void stop() override {}
    PortReply command(const PanTiltCommand& command) override {
      const std::scoped_lock lock(robot_.mutex_);
      last_ = command;
      return PortReply::accepted();
    }
    SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
      return robot_.samplesSince<PanTiltSample>(after_us, timeout);
    }
    PanTiltCommand last() const {
      const std::scoped_lock lock(robot_.mutex_);
      return last_;
    }

   private:
    Robot& robot_;
    PanTiltCommand last_;
  };

  /// One image more.
  void step() {
    const std::scoped_lock lock(mutex_);
    now_us_ += kStep_us;
    ++seq_;
    changed_.notify_all();
  }
  void turnBackTo(StampUs stamp_us) {
    const std::scoped_lock lock(mutex_);
    now_us_ = begin_us_ = stamp_us;
    changed_.notify_all();
  }
  StampUs now() const {
    const std::scoped_lock lock(mutex_);
    return now_us_;
  }
  void setOdometry(bool there) {
    const std::scoped_lock lock(mutex_);
    has_odometry_ = there;
    if (there) begin_us_ = now_us_;
  }
  void fail() {
    const std::scoped_lock lock(mutex_);
    fail_ = true;
    changed_.notify_all();
  }

  Camera camera{*this};
  Base base{*this};
  Head head{*this};

 private:
  template <typename Sample>
  SampleBatch<Sample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    const auto wentBack = [&] { return after_us > now_us_ + kSecondUs; };
    changed_.wait_for(lock, timeout, [&] { return has_odometry_ && (now_us_ > after_us || wentBack()); });
    SampleBatch<Sample> batch;
    if (!has_odometry_) return batch;
    const StampUs from_us = wentBack() ? begin_us_ - 1 : std::max(after_us, begin_us_ - 1);
    for (StampUs t = begin_us_; t <= now_us_; t += kStep_us) {
      if (t <= from_us) continue;
      Sample sample;
      sample.stamp_us = t;
      sample.seq = static_cast<std::uint64_t>(t / kStep_us);
      batch.samples.push_back(sample);
    }
    if (!batch.samples.empty()) batch.state = SourceState::kRunning;
    return batch;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  StampUs begin_us_ = 100 * kSecondUs;
  StampUs now_us_ = begin_us_;
  std::uint64_t seq_ = 0;
  bool has_odometry_ = true;
  bool fail_ = false;
};

class PerceptionLoopTest : public testing::Test {
 protected:
  explicit PerceptionLoopTest(bool has_pan_tilt = false, double images_lost_s = 0.2) : gaze_(has_pan_tilt) {
    PerceptionLoop::Params params;
    params.assembler.has_pan_tilt = has_pan_tilt;
    params.images_lost_s = images_lost_s;
    loop_ = std::make_unique<PerceptionLoop>(
        params, nullptr, robot_.camera, has_pan_tilt ? &robot_.head : nullptr, robot_.base, gaze_, status_);
    status_.serving();
    loop_->start(
        [this](const RobotObservation& observation, const auto& result) {
          last_us_ = observation.frame.stamp_us;
          memory_epoch_ = result.update.snapshot->epoch;
        },
        [](SourceState, const std::string&) {}, [this](std::exception_ptr) { failed_ = true; });
  }
  ~PerceptionLoopTest() override { loop_->stop(); }

  /// Moves the robot's time until the condition holds.
  template <typename Condition>
  bool eventually(Condition&& condition, bool with_images = true) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (condition()) return true;
      if (with_images) robot_.step();
      std::this_thread::sleep_for(2ms);
    }
    return false;
  }
  std::string reason() const { return status_.report().reason; }

  Robot robot_;
  SharedGazeClient gaze_;
  std::ostringstream lines_;
  Logger log_{"memory", LogLevel::kInfo, lines_, [] { return "T"; }};
  StatusBoard status_{"memory", "1", log_};
  std::atomic<StampUs> last_us_ = 0;
  std::atomic<std::uint32_t> memory_epoch_ = 0;
  std::atomic<bool> failed_ = false;
  std::unique_ptr<PerceptionLoop> loop_;
};

TEST_F(PerceptionLoopTest, FollowsASourceWhoseTimeTurnsBack) {
  ASSERT_TRUE(eventually([&] { return last_us_ > 100 * kSecondUs; }));
  const std::uint32_t epoch = memory_epoch_;
  robot_.turnBackTo(5 * kSecondUs);
  ASSERT_TRUE(eventually([&] { return last_us_ > 5 * kSecondUs && last_us_ < 50 * kSecondUs; })) << reason();
  EXPECT_EQ(memory_epoch_, epoch + 1) << "one event for all streams";
  ASSERT_TRUE(eventually([&] { return last_us_ > 6 * kSecondUs; })) << "and it goes on";
  EXPECT_EQ(memory_epoch_, epoch + 1);
  loop_->stop();
  EXPECT_THAT(lines_.str(), HasSubstr("INFO a new epoch, the memory is set aside: the "));
  EXPECT_THAT(lines_.str(), HasSubstr(" stamps went back by "));
}

TEST_F(PerceptionLoopTest, SaysWhatIsMissingAndGoesOnWithIt) {
  ASSERT_TRUE(eventually([&] { return last_us_ > 100 * kSecondUs; }));
  EXPECT_TRUE(eventually([&] { return reason() == "images: the camera is silent"; }, false)) << reason();
  EXPECT_TRUE(eventually([&] { return reason().empty(); })) << reason();
  robot_.setOdometry(false);
  EXPECT_TRUE(eventually([&] { return !reason().empty(); }));
  EXPECT_TRUE(eventually([&] {
    return reason().find("ahead of those of the odometry") != std::string::npos;
  })) << reason();
  robot_.setOdometry(true);
  EXPECT_TRUE(eventually([&] { return reason().empty(); })) << reason();
}

TEST_F(PerceptionLoopTest, ReportsTheCameraTilt) {
  // Grey images are not informative: the prior stays.
  ASSERT_TRUE(eventually([&] { return last_us_ > 100 * kSecondUs; }));
  ASSERT_TRUE(eventually([&] { return !status_.report().gauges.empty(); }));
  const auto gauges = status_.report().gauges;
  const TiltPrior tilt_prior;
  const double sigmas[] = {tilt_prior.mount_rad, tilt_prior.mount_rad, tilt_prior.camera_rad,
                           tilt_prior.camera_rad};
  const std::string names[] = {"mount roll error", "mount pitch error", "camera pitch error",
                               "camera roll error"};
  ASSERT_EQ(gauges.size(), 5u) << "and how far the camera was knocked";
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(gauges[i].name, names[i]);
    EXPECT_EQ(gauges[i].unit, "deg");
    EXPECT_NEAR(gauges[i].value, 0.0, 1e-6);
    EXPECT_NEAR(gauges[i].sigma, radToDeg(sigmas[i]), 1e-3);
  }
}

TEST_F(PerceptionLoopTest, AThreadThatThrowsIsReportedAtOnce) {
  ASSERT_TRUE(eventually([&] { return last_us_ > 100 * kSecondUs; }));
  robot_.fail();
  EXPECT_TRUE(eventually([&] { return failed_.load(); }, false));
}

/// Images that stay away are not missed for longer than any test lasts.
class PerceptionLoopWithAHead : public PerceptionLoopTest {
 protected:
  PerceptionLoopWithAHead() : PerceptionLoopTest(true, 3600.0) {}
};

TEST_F(PerceptionLoopWithAHead, AnUrgentRequestDoesNotWaitForAnImage) {
  // An image with its camera's pose does not wait for the joints: the first ones may come without them.
  const auto attends = [&] {
    const auto status = gaze_.status();
    return status && status->target;
  };
  ASSERT_TRUE(eventually(attends));
  ASSERT_TRUE(eventually([&] { return last_us_ == robot_.now(); }, false)) << "no image is on its way";
  const GazeRequest request{"test",          "side",          std::nullopt, PanTilt{-1.0, -0.2},
                            kUrgentPriority, 1000 * kSecondUs};
  ASSERT_TRUE(gaze_.request(request).ok());
  EXPECT_TRUE(eventually([&] { return std::abs(robot_.head.last().pan_rad + 1.0) < 1e-9; }, false));
}

}  // namespace
}  // namespace vismem
