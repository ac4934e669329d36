/// @file Stamps of recorded messages: where a clock was restarted, and samples in their order. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

/// A stamp that goes back by more begins a new epoch: a restarted clock, not messages out of order.
inline constexpr StampUs kClockBackUs = 1'000'000;

/// Number of messages, in the order of recording, before the clock jumps back; all where it does not.
template <typename Item>
std::size_t countBeforeJump(const std::vector<Item>& items) {
  StampUs newest_us = std::numeric_limits<StampUs>::min();
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0 && items[i].stamp_us < newest_us - kClockBackUs) return i;
    newest_us = std::max(newest_us, items[i].stamp_us);
  }
  return items.size();
}

/// Sorts by stamp and drops what is not newer than the one before.
template <typename Sample>
void makeIncreasing(std::vector<Sample>& samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.stamp_us < b.stamp_us; });
  samples.erase(std::unique(samples.begin(), samples.end(),
                            [](const Sample& a, const Sample& b) { return a.stamp_us == b.stamp_us; }),
                samples.end());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].seq = i;
}

}  // namespace vismem
