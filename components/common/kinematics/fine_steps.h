/// @file Motion over a time that somebody measured. Pure.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>

namespace vismem {

/// Calls `step(from_s, dt_s)` as often as it takes to cover `elapsed` in equal steps of at most 10 ms: the
/// step of the simulator, which the models are made for. Beyond the last minute nothing would change any
/// more.
template <typename Step>
void inFineSteps(std::chrono::steady_clock::duration elapsed, Step&& step) {
  constexpr double kLongestStep_s = 0.01;
  constexpr double kLongestTime_s = 60.0;
  const double total_s = std::clamp(std::chrono::duration<double>(elapsed).count(), 0.0, kLongestTime_s);
  const int count = static_cast<int>(std::ceil(total_s / kLongestStep_s));
  for (int i = 0; i < count; ++i) step(total_s * i / count, total_s / count);
}

}  // namespace vismem
