/// @file Waits for conditions in tests.
#pragma once

#include <chrono>
#include <thread>

namespace vismem {

/// Timeout for a condition: far above regular waits, because the machine may be busy.
inline constexpr std::chrono::seconds kPatience{20};

/// Polls a condition.
/// @return whether it became true in time.
template <typename Condition>
bool eventually(Condition&& condition, std::chrono::steady_clock::duration patience = kPatience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace vismem
