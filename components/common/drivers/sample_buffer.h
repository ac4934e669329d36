/// @file The last samples of a source, for those who wait for the next one.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include "common/robot/ports.h"

namespace vismem {

/// Keeps the samples of the last seconds and answers samplesSince of a port. Invariant: stamps strictly
/// increase. *Thread-safe*.
template <typename Sample>
class SampleBuffer {
 public:
  /// Stamps that go back by more than this are a new epoch (DESIGN 14).
  static constexpr StampUs kNewEpoch_us = kSecondUs;

  /// @param nothing_yet why there are no samples before the first. @param kept_us how long they are kept.
  explicit SampleBuffer(std::string nothing_yet, StampUs kept_us = 5 * kSecondUs)
      : kept_us_(kept_us), message_(std::move(nothing_yet)) {}

  /// A sample of a source that delivers. One that is not newer than the newest is left out (the clock was set
  /// back a little); one that is over a second older begins a new epoch: the others are forgotten.
  void add(const Sample& sample) {
    {
      const std::lock_guard lock(mutex_);
      state_ = SourceState::kRunning;
      if (!samples_.empty() && sample.stamp_us <= samples_.back().stamp_us) {
        if (samples_.back().stamp_us - sample.stamp_us <= kNewEpoch_us) return;
        samples_.clear();
      }
      samples_.push_back(sample);
      while (samples_.front().stamp_us + kept_us_ < sample.stamp_us) samples_.pop_front();
    }
    changed_.notify_all();
  }

  /// A condition that does not keep the source from delivering: "the stop button is pressed". It is given
  /// with the samples until it is empty again.
  void setCondition(std::string condition) {
    const std::lock_guard lock(mutex_);
    condition_ = std::move(condition);
  }

  /// The source delivers nothing for now, and why. What was delivered stays.
  void setWaiting(std::string why) {
    const std::lock_guard lock(mutex_);
    state_ = SourceState::kWaiting;
    message_ = std::move(why);
  }

  /// Nobody waits any more, until open(): what is there is still given.
  void close(std::string why) {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      state_ = SourceState::kWaiting;
      message_ = std::move(why);
    }
    changed_.notify_all();
  }
  /// Waits are possible again. @param nothing_yet why there are no new samples before the first.
  void open(std::string nothing_yet) {
    const std::lock_guard lock(mutex_);
    closed_ = false;
    message_ = std::move(nothing_yet);
  }

  /// As PanTiltUnit::samplesSince.
  SampleBatch<Sample> since(StampUs after_us, std::chrono::milliseconds timeout) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return closed_ || newestLocked() > after_us; });
    SampleBatch<Sample> batch;
    const auto first = std::upper_bound(samples_.begin(), samples_.end(), after_us,
                                        [](StampUs stamp, const Sample& s) { return stamp < s.stamp_us; });
    batch.samples.assign(first, samples_.end());
    if (!batch.samples.empty()) {
      batch.state = SourceState::kRunning;
      batch.message = condition_;
    } else {
      batch.message = state_ == SourceState::kRunning ? "no newer sample yet" : message_;
    }
    return batch;
  }

  /// Stamp of the newest sample; the smallest possible before the first.
  StampUs newest() const {
    const std::lock_guard lock(mutex_);
    return newestLocked();
  }

 private:
  StampUs newestLocked() const {
    return samples_.empty() ? std::numeric_limits<StampUs>::min() : samples_.back().stamp_us;
  }

  const StampUs kept_us_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::deque<Sample> samples_;
  bool closed_ = false;
  SourceState state_ = SourceState::kWaiting;
  std::string message_;
  std::string condition_;
};

}  // namespace vismem
