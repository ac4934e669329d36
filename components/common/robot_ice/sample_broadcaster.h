/// @file One poller of a port's samples for all remote readers.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/robot/ports.h"
#include "common/robot_ice/long_polls.h"

namespace vismem {

constexpr StampUs kBeforeAllStamps = std::numeric_limits<StampUs>::min();
/// Stamps that go back by more than this are a restart, a loop or a seek.
constexpr StampUs kBackwards_us = kSecondUs;

/// True when `stamp_us` lies more than kBackwards_us before `known_us`.
constexpr bool wentBack(StampUs stamp_us, StampUs known_us) {
  return known_us > kBeforeAllStamps + kBackwards_us && stamp_us < known_us - kBackwards_us;
}

/// Polls a port for samples on a thread of its own, keeps the last seconds and answers waiting requests.
/// Dispatch threads therefore never block on a device, and the load of the device does not depend on the
/// number of readers. It restarts when the source's time went back. *Thread-safe*; the port must allow its
/// other operations while samplesSince waits.
template <typename Sample>
class SampleBroadcaster {
 public:
  using Batch = SampleBatch<Sample>;
  using Poll = std::function<Batch(StampUs after_us, std::chrono::milliseconds timeout)>;
  using Answer = std::function<void(const Batch&)>;
  using Report = std::function<void(const Batch&)>;

  explicit SampleBroadcaster(Poll poll) : poll_(std::move(poll)) {}
  ~SampleBroadcaster() { stop(); }
  SampleBroadcaster(const SampleBroadcaster&) = delete;
  SampleBroadcaster& operator=(const SampleBroadcaster&) = delete;

  /// @param report called with each answer of the port, on the broadcaster's thread.
  void start(Report report = {}) {
    if (thread_.joinable()) return;
    report_ = std::move(report);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  /// Answers all waiting and later requests at once, and ends the thread.
  void stop() {
    thread_.request_stop();
    polls_.stop();
    if (thread_.joinable()) thread_.join();
  }

  std::optional<Sample> newest() const {
    const std::lock_guard lock(mutex_);
    if (samples_.empty()) return std::nullopt;
    return samples_.back();
  }

  /// Calls `answer` exactly once, here or later on another thread: with the samples after the stamp, or with
  /// none after `timeout`. A stamp too far ahead of the newest sample gets all kept samples.
  void whenAfter(StampUs after_us, std::chrono::milliseconds timeout, Answer answer) {
    polls_.add(timeout, [this, after_us, answer = std::move(answer)](bool last_chance) {
      const Batch batch = read(after_us);
      if (batch.samples.empty() && !last_chance) return false;
      answer(batch);
      return true;
    });
  }

  std::size_t waiting() const { return polls_.waiting(); }

 private:
  static constexpr std::chrono::milliseconds kPollWait{100};
  /// Pause after an empty answer, for ports that answer without waiting.
  static constexpr std::chrono::milliseconds kPause{10};
  static constexpr StampUs kHeld_us = 2 * kSecondUs;
  static constexpr std::size_t kMaxHeld = 4096;

  Batch read(StampUs after_us) const {
    const std::lock_guard lock(mutex_);
    if (samples_.empty()) return {state_, {}, message_};
    if (wentBack(samples_.back().stamp_us, after_us)) after_us = kBeforeAllStamps;
    Batch batch{SourceState::kRunning, {}, {}};
    for (const Sample& sample : samples_) {
      if (sample.stamp_us > after_us) batch.samples.push_back(sample);
    }
    if (!batch.samples.empty()) return batch;
    const bool running = state_ == SourceState::kRunning;
    return {running ? SourceState::kWaiting : state_, {}, running ? "nothing new yet" : message_};
  }

  void run(const std::stop_token& stop) {
    StampUs newest_us = kBeforeAllStamps;
    while (!stop.stop_requested()) {
      const auto began = std::chrono::steady_clock::now();
      Batch batch = ask(newest_us, kPollWait);
      bool restarted = false;
      if (batch.samples.empty() && newest_us != kBeforeAllStamps) {
        Batch held = ask(kBeforeAllStamps, std::chrono::milliseconds(0));
        if (!held.samples.empty() && wentBack(held.samples.back().stamp_us, newest_us)) {
          batch = std::move(held);
          restarted = true;
        }
      }
      const bool got_some = !batch.samples.empty();
      if (report_) report_(batch);
      const bool just_finished = accept(batch, restarted);
      if (got_some) {
        newest_us = batch.samples.back().stamp_us;
        polls_.changed();
      } else if (just_finished) {
        polls_.giveUpAll();
      }
      if (!got_some && std::chrono::steady_clock::now() - began < kPause) {
        std::unique_lock lock(pause_mutex_);
        pause_.wait_for(lock, stop, kPause, [] { return false; });
      }
    }
  }

  Batch ask(StampUs after_us, std::chrono::milliseconds timeout) const {
    try {
      return poll_(after_us, timeout);
    } catch (const std::exception& error) {
      return {SourceState::kWaiting, {}, error.what()};
    }
  }

  /// @return true when the source has just ended.
  bool accept(const Batch& batch, bool restarted) {
    const std::lock_guard lock(mutex_);
    if (restarted) samples_.clear();
    for (const Sample& sample : batch.samples) {
      if (!samples_.empty() && wentBack(sample.stamp_us, samples_.back().stamp_us)) samples_.clear();
      // After a short jump back: what lies ahead has not happened yet.
      while (!samples_.empty() && samples_.back().stamp_us >= sample.stamp_us) samples_.pop_back();
      samples_.push_back(sample);
    }
    while (samples_.size() > kMaxHeld ||
           (samples_.size() > 1 && samples_.front().stamp_us + kHeld_us < samples_.back().stamp_us)) {
      samples_.pop_front();
    }
    const bool just_finished = batch.state == SourceState::kFinished && state_ != SourceState::kFinished;
    state_ = batch.state;
    message_ = batch.message;
    return just_finished;
  }

  Poll poll_;
  Report report_;
  mutable std::mutex mutex_;
  std::deque<Sample> samples_;
  SourceState state_ = SourceState::kWaiting;
  std::string message_ = "no sample yet";
  std::mutex pause_mutex_;
  std::condition_variable_any pause_;
  LongPolls polls_;
  std::jthread thread_;  ///< last member: joined before the others are destroyed
};

/// Answers a long-poll for samples on the wire, here or later on another thread.
template <typename Sample, typename IceBatch>
void answerSamples(SampleBroadcaster<Sample>& samples, StampUs after_us,
                   std::function<void(const IceBatch&)> response,
                   std::function<void(std::exception_ptr)> exception) {
  samples.whenAfter(
      after_us, kLongPollWait,
      [response = std::move(response), exception = std::move(exception)](const SampleBatch<Sample>& batch) {
        try {
          IceBatch answer{toIce(batch.state), batch.message, {}};
          answer.samples.reserve(batch.samples.size());
          for (const Sample& sample : batch.samples) answer.samples.push_back(toIce(sample));
          response(answer);
        } catch (...) {
          exception(std::current_exception());
        }
      });
}

/// The samples of a batch that are newer than `after_us`; all samples when the source's time went back.
template <typename Sample>
std::vector<Sample> newerThan(std::vector<Sample> samples, StampUs after_us) {
  if (samples.empty() || wentBack(samples.back().stamp_us, after_us)) return samples;
  std::erase_if(samples, [after_us](const Sample& sample) { return sample.stamp_us <= after_us; });
  return samples;
}

}  // namespace vismem
