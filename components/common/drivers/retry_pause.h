/// @file How long a driver waits before it tries its device again. Pure.
#pragma once

#include <algorithm>
#include <chrono>

namespace vismem {

/// Twice as long after each failure, up to a limit. *Single-threaded*.
class RetryPause {
 public:
  using Duration = std::chrono::milliseconds;

  explicit RetryPause(Duration first = Duration(100), Duration longest = Duration(2000))
      : first_(first), longest_(longest), next_(first) {}

  /// It failed (again): wait this long.
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
