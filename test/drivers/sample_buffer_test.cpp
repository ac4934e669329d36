// Shared parts of drivers: samples for readers, over jumps of the clock; the period of their thread; long
// times in fine steps.
#include "common/drivers/sample_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "common/drivers/periodic_thread.h"
#include "common/kinematics/fine_steps.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr StampUs kAll = std::numeric_limits<StampUs>::min();

PanTiltSample at(StampUs stamp_us) {
  PanTiltSample sample;
  sample.stamp_us = stamp_us;
  return sample;
}

std::vector<StampUs> stamps(const SampleBatch<PanTiltSample>& batch) {
  std::vector<StampUs> result;
  for (const auto& sample : batch.samples) result.push_back(sample.stamp_us);
  return result;
}

TEST(SampleBuffer, SaysWhyThereIsNothing) {
  SampleBuffer<PanTiltSample> buffer("not started");
  EXPECT_EQ(buffer.since(kAll, 0ms).state, SourceState::kWaiting);
  EXPECT_EQ(buffer.since(kAll, 0ms).message, "not started");
  buffer.add(at(1000));
  EXPECT_EQ(buffer.since(1000, 0ms).message, "no newer sample yet");
  buffer.setWaiting("/dev/ttyUSB0 is gone");
  EXPECT_EQ(buffer.since(1000, 0ms).message, "/dev/ttyUSB0 is gone");
  EXPECT_THAT(stamps(buffer.since(kAll, 0ms)), ElementsAre(1000)) << "what was delivered stays";
  buffer.add(at(2000));
  EXPECT_EQ(buffer.since(2000, 0ms).message, "no newer sample yet") << "it is back";
}

TEST(SampleBuffer, KeepsTheLastSecondsOnly) {
  SampleBuffer<PanTiltSample> buffer("", 2 * kSecondUs);
  for (StampUs t = 0; t <= 10; ++t) buffer.add(at(t * kSecondUs));
  EXPECT_THAT(stamps(buffer.since(kAll, 0ms)), ElementsAre(8 * kSecondUs, 9 * kSecondUs, 10 * kSecondUs));
}

/// The host's clock is set back by an hour: the old samples' stamps mean nothing any more. By a little:
/// samples are left out until the clock has caught up, because stamps must rise.
TEST(SampleBuffer, SurvivesAClockThatIsSetBack) {
  SampleBuffer<PanTiltSample> buffer("");
  buffer.add(at(7200 * kSecondUs));
  buffer.add(at(7200 * kSecondUs - 400'000));
  buffer.add(at(7200 * kSecondUs));
  EXPECT_THAT(stamps(buffer.since(kAll, 0ms)), ElementsAre(7200 * kSecondUs));
  buffer.add(at(3600 * kSecondUs));
  buffer.add(at(3600 * kSecondUs + 10'000));
  EXPECT_THAT(stamps(buffer.since(kAll, 0ms)), ElementsAre(3600 * kSecondUs, 3600 * kSecondUs + 10'000));
  EXPECT_EQ(buffer.newest(), 3600 * kSecondUs + 10'000);
}

TEST(SampleBuffer, WaitsEndOnceItIsClosed) {
  SampleBuffer<PanTiltSample> buffer("");
  buffer.add(at(1000));
  buffer.close("stopped");
  const auto batch = buffer.since(1000, 60s);  // or the test times out
  EXPECT_EQ(batch.message, "stopped");
  EXPECT_THAT(stamps(buffer.since(0, 60s)), ElementsAre(1000));
  buffer.open("no sample yet");
  const auto asked = std::chrono::steady_clock::now();
  EXPECT_EQ(buffer.since(1000, 20ms).message, "no sample yet");
  EXPECT_GE(std::chrono::steady_clock::now() - asked, 19ms);
}

TEST(PeriodicThread, WorksUntilStoppedAndMayBeginAgain) {
  PeriodicThread thread;
  std::atomic<int> rounds = 0;
  for (int life = 1; life <= 2; ++life) {
    rounds = 0;
    thread.start(1ms, [&] { ++rounds; });
    while (rounds < 5) std::this_thread::yield();
    thread.stop();
    const int after = rounds;
    std::this_thread::yield();
    EXPECT_EQ(rounds, after);
  }
}

TEST(FineSteps, CoverATimeEvenlyAndGiveUpAfterAMinute) {
  std::vector<double> steps;
  const auto note = [&](double, double dt_s) { steps.push_back(dt_s); };
  inFineSteps(0ms, note);
  EXPECT_THAT(steps, IsEmpty());
  inFineSteps(25ms, note);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_NEAR(steps[0] + steps[1] + steps[2], 0.025, 1e-12);
  steps.clear();
  inFineSteps(std::chrono::hours(5), note);
  EXPECT_EQ(steps.size(), 6000U);
}

}  // namespace
}  // namespace vismem
