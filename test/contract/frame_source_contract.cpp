// The contract of FrameSource. Each test is run for every implementation.
#include "contract/frame_source_contract.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <future>
#include <thread>

#include "common/geometry/camera.h"

namespace vismem {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// Nothing waits that long unless something is wrong.
constexpr auto kPatience = 20s;
/// By how much a busy machine may be late where a promise is about time.
constexpr auto kLate = 1500ms;

double megapixels(const Frame& frame) {
  return 1e-6 * frame.image.cols * frame.image.rows;
}

}  // namespace

Frame FrameSourceContract::take() {
  const auto deadline = Clock::now() + kPatience;
  FrameResult result;
  while (Clock::now() < deadline) {
    rig_->provoke();
    result = source().next(200ms);
    EXPECT_EQ(result.frame.has_value(), result.state == SourceState::kRunning) << result.message;
    if (result.frame) return *std::move(result.frame);
  }
  ADD_FAILURE() << "no frame: " << result.message;
  return {};
}

TEST_P(FrameSourceContract, SaysWhatItIsAndDelivers) {
  open();
  EXPECT_NE(source().capabilities().name, "");
  const PortReply configured = source().configure({});
  EXPECT_TRUE(configured.ok()) << configured.message;
  const PortReply started = source().start();
  EXPECT_TRUE(started.ok()) << started.message;
  const Frame frame = take();
  const FrameCapabilities capabilities = source().capabilities();
  EXPECT_EQ(capabilities.width, frame.intrinsics.width);
  EXPECT_EQ(capabilities.height, frame.intrinsics.height);
  EXPECT_EQ(capabilities.knows_camera_pose, frame.T_robot_camera.has_value());
}

TEST_P(FrameSourceContract, FramesAreWholeAndAlike) {
  open();
  source().configure({});
  source().start();
  const Frame first = take();
  for (int i = 0; i < 4; ++i) {
    const Frame frame = i == 0 ? first : take();
    ASSERT_FALSE(frame.image.empty());
    EXPECT_TRUE(frame.image.type() == CV_8UC3 || frame.image.type() == CV_8UC1) << frame.image.type();
    EXPECT_EQ(frame.native, nullptr) << "not requested";
    EXPECT_EQ(checkIntrinsics(frame.intrinsics), "");
    EXPECT_EQ(frame.intrinsics.width, frame.image.cols);
    EXPECT_EQ(frame.intrinsics.height, frame.image.rows);
    EXPECT_EQ(frame.intrinsics, first.intrinsics);
    EXPECT_EQ(frame.image.type(), first.image.type());
    EXPECT_GT(megapixels(frame), 0.0);
  }
}

TEST_P(FrameSourceContract, MayGiveThePictureAsCapturedToWhoAsksForIt) {
  open();
  FrameRequest request;
  request.accept_native = true;
  ASSERT_TRUE(source().configure(request).ok());
  source().start();
  const Frame frame = take();
  ASSERT_TRUE(!frame.image.empty() || frame.native);
  if (!frame.native) return;
  EXPECT_EQ(frame.native->width, frame.intrinsics.width);
  EXPECT_EQ(frame.native->height, frame.intrinsics.height);
  EXPECT_FALSE(frame.native->bytes.empty());
}

TEST_P(FrameSourceContract, StampsAndNumbersRise) {
  open();
  source().configure({});
  source().start();
  Frame last = take();
  for (int i = 0; i < 5; ++i) {
    const Frame frame = take();
    EXPECT_GT(frame.stamp_us, last.stamp_us);
    EXPECT_GT(frame.seq, last.seq);
    last = frame;
  }
}

TEST_P(FrameSourceContract, TheNewestFrameWins) {
  open();
  source().configure({});
  source().start();
  const Frame first = take();
  // A consumer that is busy for five periods; in lock-step, five steps without a read.
  const auto busy_until = Clock::now() + std::chrono::duration<double>(5.5 * rig_->period_s());
  if (rig_->waits()) {
    std::this_thread::sleep_until(busy_until);
  } else {
    for (int i = 0; i < 5; ++i) rig_->provoke();
  }
  const FrameResult next = source().next(rig_->waits() ? 1000ms : 0ms);
  ASSERT_TRUE(next.frame) << next.message;
  EXPECT_GE(next.frame->seq, first.seq + 2) << "frames in between are passed over";
  EXPECT_GE(toSeconds(next.frame->stamp_us - first.stamp_us), 1.5 * rig_->period_s());
}

TEST_P(FrameSourceContract, KeepsTheTimeout) {
  open(Supply::kOne);
  source().configure({});
  source().start();
  take();
  rig_->hush();
  // Frames from before its silence.
  while (source().next(300ms).frame) continue;
  for (const auto timeout : {0ms, 150ms}) {
    const auto began = Clock::now();
    const FrameResult result = source().next(timeout);
    const auto took = Clock::now() - began;
    EXPECT_FALSE(result.frame);
    EXPECT_NE(result.state, SourceState::kRunning);
    EXPECT_LT(took, timeout + kLate);
    if (rig_->waits() && result.state == SourceState::kWaiting) {
      EXPECT_GE(took, timeout - 1ms);
    }
  }
}

TEST_P(FrameSourceContract, GivesNothingOnceStopped) {
  open();
  source().configure({});
  source().start();
  take();
  source().stop();
  rig_->provoke();
  for (int i = 0; i < 3; ++i) {
    const auto began = Clock::now();
    const FrameResult result = source().next(50ms);
    EXPECT_EQ(result.state, SourceState::kWaiting);
    EXPECT_FALSE(result.frame);
    EXPECT_NE(result.message, "") << "says why";
    EXPECT_LT(Clock::now() - began, 50ms + kLate);
  }
}

TEST_P(FrameSourceContract, StartsAgainAfterAStop) {
  open();
  source().configure({});
  source().start();
  const Frame before = take();
  source().stop();
  ASSERT_TRUE(source().start().ok());
  const Frame after = take();
  EXPECT_GT(after.seq, before.seq);
  EXPECT_GT(after.stamp_us, before.stamp_us);
  EXPECT_EQ(after.image.size(), before.image.size());
}

TEST_P(FrameSourceContract, StartAndStopMayBeRepeated) {
  open();
  source().stop();
  source().configure({});
  source().start();
  EXPECT_TRUE(source().start().ok());
  take();
  source().stop();
  source().stop();
  EXPECT_TRUE(source().start().ok());
  take();
}

TEST_P(FrameSourceContract, StopEndsAWait) {
  open(Supply::kOne);
  source().configure({});
  source().start();
  take();
  rig_->hush();
  if (!rig_->waits()) {  // there is no wait to be ended
    const auto asked = Clock::now();
    EXPECT_FALSE(source().next(30s).frame);
    EXPECT_LT(Clock::now() - asked, kLate);
    return;
  }
  std::promise<void> waiting;
  auto waiter = std::async(std::launch::async, [&] {
    waiting.set_value();
    while (source().next(30s).frame) continue;
  });
  waiting.get_future().wait();
  // Lets it get into its wait. If it does not, stop() comes before, which must do as well.
  std::this_thread::sleep_for(20ms);
  const auto began = Clock::now();
  source().stop();
  EXPECT_LT(Clock::now() - began, kLate) << "stop() itself";
  ASSERT_EQ(waiter.wait_for(kPatience), std::future_status::ready);
  EXPECT_LT(Clock::now() - began, kLate);
}

TEST_P(FrameSourceContract, RejectsAbsurdRequestsWithAReason) {
  open();
  for (const FrameRequest& request :
       {FrameRequest{-1, 240, 0.0}, FrameRequest{320, -240, 0.0}, FrameRequest{2'000'000'000, 1, 0.0},
        FrameRequest{320, 240, -1.0}, FrameRequest{320, 240, std::nan("")}, FrameRequest{320, 240, HUGE_VAL},
        FrameRequest{320, 240, 1e30}}) {
    const PortReply reply = source().configure(request);
    EXPECT_EQ(reply.kind, PortReply::Kind::kRejected) << request.width << " " << request.rate_hz;
    EXPECT_NE(reply.message, "");
  }
  ASSERT_TRUE(source().configure({}).ok()) << "and is as good as before";
  source().start();
  take();
}

TEST_P(FrameSourceContract, KeepsWhatItAnswersToARequest) {
  for (const FrameRequest& request : {FrameRequest{160, 120, 0.0}, FrameRequest{64, 64, 7.0},
                                      FrameRequest{0, 48, 0.0}, FrameRequest{0, 0, 25.0}}) {
    open();
    const PortReply reply = source().configure(request);
    EXPECT_EQ(reply.kind == PortReply::Kind::kAccepted, reply.message.empty()) << reply.message;
    if (!reply.ok()) continue;
    source().start();
    const Frame frame = take();
    if (reply.kind != PortReply::Kind::kAccepted) continue;
    EXPECT_TRUE(request.width == 0 || frame.image.cols == request.width) << frame.image.cols;
    EXPECT_TRUE(request.height == 0 || frame.image.rows == request.height) << frame.image.rows;
    const double rate_hz = source().capabilities().rate_hz;
    EXPECT_TRUE(request.rate_hz == 0.0 || std::abs(rate_hz - request.rate_hz) < 1e-6) << rate_hz;
  }
}

TEST_P(FrameSourceContract, MayBeDestroyedWhileItRuns) {
  open();
  source().configure({});
  source().start();
  take();
  const auto began = Clock::now();
  rig_.reset();
  EXPECT_LT(Clock::now() - began, kPatience);
}

}  // namespace vismem
