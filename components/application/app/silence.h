/// @file Distinguishes a robot whose time stands still by a fault from one that is paused.
#pragma once

#include <algorithm>
#include <chrono>

namespace vismem {

/// Longest time without data before the run fails; longer than any pause of a working robot.
inline constexpr std::chrono::seconds kSilence{15};

/// Measures how long the robot's time has stood still without a pause. *Single-threaded.*
class Silence {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// @param last_advance when the robot's time last changed.
  /// @param is_paused by command; the silence begins after it.
  /// @return whether it has stood still for longer than kSilence.
  bool isTooLong(TimePoint now, TimePoint last_advance, bool is_paused) {
    if (is_paused) last_paused_ = now;
    return now - std::max(last_advance, last_paused_) > kSilence;
  }

 private:
  TimePoint last_paused_ = TimePoint::min();
};

}  // namespace vismem
