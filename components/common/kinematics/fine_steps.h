/// @file Division of a measured time into the simulator's steps. Pure.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>

namespace vismem {

/// Calls `step(from_s, dt_s)` for equal steps of at most 10 ms, the step of the simulator, that cover
/// `elapsed`. Only the last minute is covered: all motion has ended by then.
template <typename Step>
void inFineSteps(std::chrono::steady_clock::duration elapsed, Step&& step) {
  constexpr double kLongestStep_s = 0.01;
  constexpr double kLongestTime_s = 60.0;
  const double total_s = std::clamp(std::chrono::duration<double>(elapsed).count(), 0.0, kLongestTime_s);
  const int count = static_cast<int>(std::ceil(total_s / kLongestStep_s));
  for (int i = 0; i < count; ++i) step(total_s * i / count, total_s / count);
}

}  // namespace vismem
