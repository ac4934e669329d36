/// @file The newest value of a stream, for many readers: local ones block, remote ones long-poll.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "common/robot/ports.h"
#include "common/robot_ice/long_polls.h"

namespace vismem {

/// Holds one immutable value with a revision. Readers request a value whose revision *differs* from theirs,
/// not a higher one: revisions go back when the producer restarts, and readers must not wait then. Values in
/// between are skipped. *Thread-safe.*
template <typename Value>
class LatestValue {
 public:
  struct Reading {
    SourceState state = SourceState::kWaiting;
    std::shared_ptr<const Value> value;  ///< null: no new value; set only with kRunning
    std::int64_t revision = -1;
    std::string message;  ///< reason why there is no value
  };
  using Answer = std::function<void(const Reading&)>;

  explicit LatestValue(std::string nothing_yet) : message_(std::move(nothing_yet)) {}

  void publish(std::shared_ptr<const Value> value, std::int64_t revision) {
    {
      const std::lock_guard lock(mutex_);
      value_ = std::move(value);
      revision_ = revision;
      state_ = SourceState::kRunning;
      message_.clear();
    }
    changed_.notify_all();
    polls_.changed();
  }

  /// Sets the state of a source without new values; the last value stays readable. The end of a log ends all
  /// waits at once.
  void setState(SourceState state, std::string message) {
    bool just_finished = false;
    {
      const std::lock_guard lock(mutex_);
      just_finished = state == SourceState::kFinished && state_ != state;
      state_ = state;
      message_ = std::move(message);
    }
    if (just_finished) {
      changed_.notify_all();
      polls_.giveUpAll();
    }
  }

  /// The newest value, null before the first.
  std::shared_ptr<const Value> latest() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }
  std::string message() const {
    const std::lock_guard lock(mutex_);
    return message_;
  }

  /// Blocks at most `timeout` for a value with another revision; ends early at the end of a log and on
  /// stop().
  Reading waitOther(std::optional<std::int64_t> have, std::chrono::milliseconds timeout) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout,
                      [&] { return stopped_ || isOther(have) || state_ == SourceState::kFinished; });
    return read(have);
  }

  /// Calls `answer` exactly once, here or later on another thread; see LongPolls.
  void whenOther(std::optional<std::int64_t> have, std::chrono::milliseconds timeout, Answer answer) {
    polls_.add(timeout, [this, have, answer = std::move(answer)](bool last_chance) {
      Reading reading;
      {
        const std::lock_guard lock(mutex_);
        reading = read(have);
      }
      if (!reading.value && !last_chance) return false;
      answer(reading);
      return true;
    });
  }

  /// Answers all waiting and later requests at once.
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    polls_.stop();
  }
  std::size_t waiting() const { return polls_.waiting(); }
  /// See LongPolls::onKept.
  void onKept(std::function<void()> kept) { polls_.onKept(std::move(kept)); }

 private:
  bool isOther(std::optional<std::int64_t> have) const { return value_ && (!have || *have != revision_); }

  Reading read(std::optional<std::int64_t> have) const {
    if (isOther(have)) return {SourceState::kRunning, value_, revision_, {}};
    // The source runs, but the caller has its newest value.
    if (state_ == SourceState::kRunning)
      return {SourceState::kWaiting, nullptr, revision_, "nothing new yet"};
    return {state_, nullptr, revision_, message_};
  }

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::shared_ptr<const Value> value_;
  std::int64_t revision_ = -1;
  SourceState state_ = SourceState::kWaiting;
  std::string message_;
  bool stopped_ = false;
  LongPolls polls_;  ///< last member: its thread ends before the rest goes
};

}  // namespace vismem
