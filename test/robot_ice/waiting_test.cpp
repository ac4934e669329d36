// Waiting requests, the newest value and the broadcaster of samples, without Ice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>

#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

/// Long enough that only a failure waits for it.
constexpr auto kNever = std::chrono::milliseconds(60'000);

TEST(LongPolls, AnswersAtOnceWhenThereIsSomething) {
  LongPolls polls;
  int answered = 0;
  polls.add(kNever, [&](bool) { return ++answered > 0; });
  EXPECT_EQ(answered, 1);
  EXPECT_EQ(polls.waiting(), 0U);
}

TEST(LongPolls, KeepsARequestUntilAChangeThatAnswersIt) {
  LongPolls polls;
  bool ready = false;
  int answered = 0;
  polls.add(kNever, [&](bool last_chance) {
    if (!ready && !last_chance) return false;
    ++answered;
    return true;
  });
  polls.changed();
  EXPECT_EQ(answered, 0);
  EXPECT_EQ(polls.waiting(), 1U);
  ready = true;
  polls.changed();
  polls.changed();
  EXPECT_EQ(answered, 1);
}

TEST(LongPolls, AnswersInTimeWithoutAChange) {
  LongPolls polls;
  std::promise<bool> answered;
  polls.add(kNever,
            [](bool last_chance) { return last_chance; });  // a later deadline must not hold up this one
  polls.add(5ms, [&](bool last_chance) {
    if (last_chance) answered.set_value(true);
    return last_chance;
  });
  EXPECT_EQ(answered.get_future().wait_for(10s), std::future_status::ready);
}

TEST(LongPolls, StopAnswersEverybodyNowAndLater) {
  LongPolls polls;
  int answered = 0;
  const auto only_at_last = [&](bool last_chance) {
    answered += last_chance ? 1 : 0;
    return last_chance;
  };
  polls.add(kNever, only_at_last);
  polls.add(kNever, only_at_last);
  polls.stop();
  EXPECT_EQ(answered, 2);
  polls.add(kNever, only_at_last);
  EXPECT_EQ(answered, 3);
}

TEST(LongPolls, ReportsEachRequestThatItKeeps) {
  LongPolls polls;
  std::size_t seen_waiting = 0;
  int kept = 0;
  polls.onKept([&] {
    ++kept;
    seen_waiting = polls.waiting();
  });
  polls.add(kNever, [](bool) { return true; });
  EXPECT_EQ(kept, 0) << "it was answered at once";
  polls.add(kNever, [](bool last_chance) { return last_chance; });
  EXPECT_EQ(kept, 1);
  EXPECT_EQ(seen_waiting, 1U);
  polls.changed();
  EXPECT_EQ(kept, 2) << "kept again";
}

TEST(LongPolls, BoundsHowManyWait) {
  LongPolls polls;
  int answered = 0;
  for (std::size_t i = 0; i < LongPolls::kMaxWaiting + 10; ++i) {
    polls.add(kNever, [&](bool last_chance) {
      answered += last_chance ? 1 : 0;
      return last_chance;
    });
  }
  EXPECT_EQ(answered, 10);
  EXPECT_EQ(polls.waiting(), LongPolls::kMaxWaiting);
}

TEST(LongPolls, NoChangeIsMissedWhileThreadsAddAndReport) {
  constexpr int kRequests = 200;  // below the bound: none is let go early
  for (int round = 0; round < 50; ++round) {
    LongPolls polls;
    std::atomic<int> value = 0;
    std::atomic<int> answered = 0;
    std::jthread producer([&] {
      for (int i = 1; i <= kRequests; ++i) {
        value = i;
        polls.changed();
      }
    });
    for (int i = 0; i < kRequests; ++i) {
      polls.add(kNever, [&, i](bool) {
        if (value <= i) return false;
        ++answered;
        return true;
      });
    }
    producer.join();
    ASSERT_EQ(polls.waiting(), 0U);
    ASSERT_EQ(answered, kRequests);
  }
}

TEST(LatestValue, GivesTheNewestAndPassesOverTheRest) {
  LatestValue<int> value("nothing yet");
  EXPECT_EQ(value.waitOther(std::nullopt, 0ms).message, "nothing yet");
  value.publish(std::make_shared<const int>(10), 1);
  value.publish(std::make_shared<const int>(20), 2);
  const auto reading = value.waitOther(std::nullopt, 0ms);
  ASSERT_TRUE(reading.value);
  EXPECT_EQ(*reading.value, 20);
  EXPECT_EQ(reading.revision, 2);
  EXPECT_FALSE(value.waitOther(2, 0ms).value);
}

TEST(LatestValue, AnswersACallerAheadOfARestartedProducer) {
  LatestValue<int> value("nothing yet");
  value.publish(std::make_shared<const int>(10), 3);
  const auto reading = value.waitOther(900, 0ms);
  ASSERT_TRUE(reading.value);
  EXPECT_EQ(reading.revision, 3);
}

TEST(LatestValue, ReportsTheEndOfALogAtOnce) {
  LatestValue<int> value("nothing yet");
  value.publish(std::make_shared<const int>(10), 1);
  std::promise<SourceState> state;
  value.whenOther(1, kNever, [&](const auto& reading) { state.set_value(reading.state); });
  value.setState(SourceState::kFinished, "end of log");
  EXPECT_EQ(state.get_future().get(), SourceState::kFinished);
  EXPECT_TRUE(value.latest());
}

TEST(LatestValue, StopWakesLocalReaders) {
  LatestValue<int> value("nothing yet");
  auto reading = std::async(std::launch::async, [&] { return value.waitOther(std::nullopt, kNever); });
  value.stop();
  EXPECT_FALSE(reading.get().value);
}

PanTiltSample sampleAt(StampUs stamp_us) {
  return {stamp_us, static_cast<std::uint64_t>(stamp_us), 0, 0};
}

std::vector<StampUs> stampsOf(const std::vector<PanTiltSample>& samples) {
  std::vector<StampUs> stamps;
  for (const auto& sample : samples) stamps.push_back(sample.stamp_us);
  return stamps;
}

/// A port whose samples a test sets.
class ScriptedSamples {
 public:
  void set(std::vector<PanTiltSample> samples) {
    const std::lock_guard lock(mutex_);
    samples_ = std::move(samples);
  }
  SampleBatch<PanTiltSample> since(StampUs after_us, std::chrono::milliseconds) {
    const std::lock_guard lock(mutex_);
    SampleBatch<PanTiltSample> batch{SourceState::kRunning, {}, {}};
    for (const auto& sample : samples_) {
      if (sample.stamp_us > after_us) batch.samples.push_back(sample);
    }
    if (batch.samples.empty()) return {SourceState::kWaiting, {}, "unplugged"};
    return batch;
  }

 private:
  std::mutex mutex_;
  std::vector<PanTiltSample> samples_;
};

class Samples : public ::testing::Test {
 protected:
  SampleBatch<PanTiltSample> after(StampUs after_us) {
    std::promise<SampleBatch<PanTiltSample>> batch;
    broadcaster.whenAfter(after_us, 10s, [&](const auto& answer) { batch.set_value(answer); });
    return batch.get_future().get();
  }
  ScriptedSamples port;
  SampleBroadcaster<PanTiltSample> broadcaster{
      [this](StampUs after_us, std::chrono::milliseconds timeout) { return port.since(after_us, timeout); }};
};

TEST_F(Samples, GivesWhatIsNewer) {
  port.set({sampleAt(100), sampleAt(200), sampleAt(300)});
  broadcaster.start();
  EXPECT_THAT(stampsOf(after(kBeforeAllStamps).samples), ElementsAre(100, 200, 300));
  EXPECT_THAT(stampsOf(after(150).samples), ElementsAre(200, 300));
  EXPECT_EQ(broadcaster.newest()->stamp_us, 300);
}

TEST_F(Samples, BeginsAnewWhenTheSourcesTimeGoesBack) {
  port.set({sampleAt(60 * kSecondUs)});
  broadcaster.start();
  EXPECT_EQ(after(0).samples.size(), 1U);
  port.set({sampleAt(1000), sampleAt(2000)});
  // The caller is at 60 s; the first answer after the restart is all of the new epoch.
  EXPECT_THAT(stampsOf(after(60 * kSecondUs).samples), ElementsAre(1000, 2000));
}

TEST_F(Samples, StopAnswersWithTheReason) {
  broadcaster.start();
  std::promise<std::string> message;
  std::atomic<bool> answered = false;
  broadcaster.whenAfter(0, kNever, [&](const auto& batch) {
    answered = true;
    message.set_value(batch.message);
  });
  EXPECT_FALSE(answered);
  broadcaster.stop();
  EXPECT_FALSE(message.get_future().get().empty());
}

TEST(NewerThan, DropsWhatTheCallerHasUnlessTimeWentBack) {
  EXPECT_THAT(stampsOf(newerThan<PanTiltSample>({sampleAt(1), sampleAt(2)}, 1)), ElementsAre(2));
  EXPECT_THAT(stampsOf(newerThan<PanTiltSample>({sampleAt(1), sampleAt(2)}, 60 * kSecondUs)),
              ElementsAre(1, 2));
  EXPECT_THAT(stampsOf(newerThan<PanTiltSample>({sampleAt(1)}, kBeforeAllStamps)), ElementsAre(1));
}

}  // namespace
}  // namespace vismem
