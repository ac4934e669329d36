/// @file Contract tests of samples, shared by the suites of PanTiltUnit and MobileBase.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

#include "common/robot/ports.h"

namespace vismem::contract {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr StampUs kEverything = std::numeric_limits<StampUs>::min();
/// Timeout of a test, far above all regular waits.
constexpr auto kPatience = 20s;
/// Additional wait on a busy machine.
constexpr auto kSlack = 2s;

/// One implementation of a port, ready to start, with its environment.
template <typename Port>
class Subject {
 public:
  virtual ~Subject() = default;
  virtual Port& port() = 0;
  /// Lock-step implementations move time on by one step; for all others it passes by itself.
  virtual void step() {}
  virtual bool isLockStep() const { return false; }
};

/// For INSTANTIATE_TEST_SUITE_P.
template <typename Port>
struct Implementation {
  const char* name;
  std::unique_ptr<Subject<Port>> (*make)();
};
template <typename Port>
void PrintTo(const Implementation<Port>& implementation, std::ostream* out) {
  *out << implementation.name;
}
struct ImplementationName {
  template <typename Info>
  std::string operator()(const Info& test) const {
    return test.param.name;
  }
};

/// Follows the samples of a started port, none twice.
template <typename Port>
class Follower {
 public:
  using Batch = decltype(std::declval<Port>().samplesSince(StampUs{}, 0ms));
  using Sample = typename decltype(Batch::samples)::value_type;

  explicit Follower(Subject<Port>& subject) : subject_(subject) {}

  /// The samples that come next; empty at the deadline.
  std::vector<Sample> next() {
    const auto deadline = Steady::now() + kPatience;
    do {
      subject_.step();
      Batch batch = subject_.port().samplesSince(newest_us_, 100ms);
      EXPECT_EQ(batch.state == SourceState::kRunning, !batch.samples.empty()) << batch.message;
      if (!batch.samples.empty()) {
        newest_us_ = batch.samples.back().stamp_us;
        return std::move(batch.samples);
      }
    } while (Steady::now() < deadline);
    ADD_FAILURE() << "no sample came";
    return {};
  }

  /// The first sample that fulfils the condition, before the patience ends.
  /// @param each is done before each look.
  std::optional<Sample> until(
      const std::function<bool(const Sample&)>& condition, const std::function<void()>& each = [] {}) {
    const auto deadline = Steady::now() + kPatience;
    while (Steady::now() < deadline) {
      each();
      for (const Sample& sample : next()) {
        if (condition(sample)) return sample;
      }
    }
    return std::nullopt;
  }

  /// All samples from the next one on until their stamps have moved on by so much.
  std::vector<Sample> during(
      StampUs span_us, const std::function<void()>& each = [] {}) {
    std::vector<Sample> all;
    until(
        [&](const Sample& sample) {
          all.push_back(sample);
          return sample.stamp_us - all.front().stamp_us >= span_us;
        },
        each);
    return all;
  }

  StampUs newest() const { return newest_us_; }

 private:
  Subject<Port>& subject_;
  StampUs newest_us_ = kEverything;
};

template <typename Port>
void startsAndStopsAsOftenAsOneLikes(Subject<Port>& subject) {
  Port& port = subject.port();
  for (int life = 0; life < 2; ++life) {
    ASSERT_TRUE(port.start().ok());
    ASSERT_TRUE(port.start().ok()) << "started twice";
    Follower<Port> follower(subject);
    EXPECT_FALSE(follower.next().empty());
    port.stop();
    port.stop();
    // A stopped port ends all waits at once.
    const auto asked = Steady::now();
    port.samplesSince(std::numeric_limits<StampUs>::max(), 10s);
    EXPECT_LT(Steady::now() - asked, kSlack);
  }
}

template <typename Port>
void stampsAndNumbersRise(Subject<Port>& subject) {
  ASSERT_TRUE(subject.port().start().ok());
  Follower<Port> follower(subject);
  const auto samples = follower.during(kSecondUs / 2);
  ASSERT_GE(samples.size(), 3U);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(samples[i].stamp_us, samples[i - 1].stamp_us);
    EXPECT_GT(samples[i].seq, samples[i - 1].seq);
  }
}

template <typename Port>
void givesWhatIsNewerAndStillHeld(Subject<Port>& subject) {
  Port& port = subject.port();
  ASSERT_TRUE(port.start().ok());
  Follower<Port> follower(subject);
  const auto seen = follower.during(kSecondUs);
  ASSERT_GE(seen.size(), 3U);
  // All that came in the last second is still there, and nothing that is not newer than asked for.
  const StampUs middle_us = seen[seen.size() / 2].stamp_us;
  const auto later = port.samplesSince(middle_us, 1000ms).samples;
  ASSERT_GE(later.size(), seen.size() - seen.size() / 2 - 1);
  EXPECT_EQ(later.front().stamp_us, seen[seen.size() / 2 + 1].stamp_us);
  const auto all = port.samplesSince(seen.front().stamp_us - 1, 1000ms).samples;
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front().stamp_us, seen.front().stamp_us);
}

template <typename Port>
void waitsForItsWholeTimeout(Subject<Port>& subject) {
  Port& port = subject.port();
  ASSERT_TRUE(port.start().ok());
  Follower<Port> follower(subject);
  ASSERT_FALSE(follower.next().empty());
  // Nothing can be newer than this for a while.
  const auto asked = Steady::now();
  const auto batch = port.samplesSince(follower.newest() + 9 * kSecondUs / 10, 100ms);
  const auto waited = Steady::now() - asked;
  EXPECT_TRUE(batch.samples.empty());
  EXPECT_EQ(batch.state, SourceState::kWaiting);
  EXPECT_FALSE(batch.message.empty()) << "for what it waits";
  EXPECT_LT(waited, 100ms + kSlack);
  // It does wait, so that readers need no pause of their own; only lock-step returns at once.
  if (!subject.isLockStep()) {
    EXPECT_GE(waited, 95ms);
  }
}

/// @param command is tried many times while another thread reads; it gives the port's answer.
template <typename Port>
void takesCommandsWhileOthersWait(Subject<Port>& subject, const std::function<PortReply(int)>& command) {
  Port& port = subject.port();
  ASSERT_TRUE(port.start().ok());
  std::atomic<bool> done = false;
  std::atomic<int> batches = 0;
  std::jthread reader([&] {
    StampUs newest_us = kEverything;
    while (!done) {
      const auto batch = port.samplesSince(newest_us, 1000ms);
      for (const auto& sample : batch.samples) {
        EXPECT_GT(sample.stamp_us, newest_us);
        newest_us = sample.stamp_us;
      }
      if (!batch.samples.empty()) ++batches;
    }
  });
  const auto deadline = Steady::now() + kPatience;
  for (int i = 0; i < 100 || batches < 10; ++i) {
    ASSERT_LT(Steady::now(), deadline);
    const auto asked = Steady::now();
    const PortReply reply = command(i);
    EXPECT_EQ(reply.kind, PortReply::Kind::kAccepted) << reply.message;
    EXPECT_LT(Steady::now() - asked, 1s + kSlack);
  }
  done = true;
}

/// For implementations that wait by themselves.
template <typename Port>
void stopEndsAWait(Subject<Port>& subject) {
  Port& port = subject.port();
  ASSERT_TRUE(port.start().ok());
  std::atomic<bool> waits = false;
  Steady::time_point ended;
  std::thread reader([&] {
    waits = true;
    port.samplesSince(std::numeric_limits<StampUs>::max(), 30s);
    ended = Steady::now();
  });
  while (!waits) std::this_thread::yield();
  port.stop();
  const auto stopped = Steady::now();
  reader.join();
  EXPECT_LT(ended - stopped, kSlack);
}

}  // namespace vismem::contract
