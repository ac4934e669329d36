/// @file The last samples of a source, with blocking reads of new ones.
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
  /// Stamps that go back by more than this are a new epoch.
  static constexpr StampUs kNewEpoch_us = kSecondUs;

  /// @param nothing_yet reason given before the first sample.
  /// @param kept_us how long samples are kept [us].
  explicit SampleBuffer(std::string nothing_yet, StampUs kept_us = 5 * kSecondUs)
      : kept_us_(kept_us), message_(std::move(nothing_yet)) {}

  /// Adds a sample. A sample that is up to kNewEpoch_us older than the newest is dropped (the clock was set
  /// back a little). An older one begins a new epoch: all earlier samples are deleted.
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

  /// Sets a condition of a source that still delivers: "the stop button is pressed". It accompanies the
  /// samples until it is empty again.
  void setCondition(std::string condition) {
    const std::lock_guard lock(mutex_);
    condition_ = std::move(condition);
  }

  /// Sets the reason why the source delivers no samples now. Earlier samples are kept.
  void setWaiting(std::string why) {
    const std::lock_guard lock(mutex_);
    state_ = SourceState::kWaiting;
    message_ = std::move(why);
  }

  /// Ends all waits until open(). Kept samples can still be read.
  void close(std::string why) {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      state_ = SourceState::kWaiting;
      message_ = std::move(why);
    }
    changed_.notify_all();
  }
  /// Allows waits again.
  /// @param nothing_yet reason given before the first new sample.
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
