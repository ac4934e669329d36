/// @file Exponential back-off of a driver that lost its device. Pure.
#pragma once

#include <algorithm>
#include <chrono>

namespace vismem {

/// The pause doubles after each failure, up to a limit. *Single-threaded*.
class RetryPause {
 public:
  using Duration = std::chrono::milliseconds;

  explicit RetryPause(Duration first = Duration(100), Duration longest = Duration(2000))
      : first_(first), longest_(longest), next_(first) {}

  /// To be called after a failure.
  /// @return the pause before the next attempt.
  Duration failed() {
    const Duration pause = next_;
    next_ = std::min(2 * next_, longest_);
    return pause;
  }
  void worked() { next_ = first_; }

 private:
  const Duration first_;
  const Duration longest_;
  Duration next_;
};

}  // namespace vismem
