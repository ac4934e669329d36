/// @file Waiting for what must happen, in tests.
#pragma once

#include <chrono>
#include <thread>

namespace vismem {

/// How long a test waits for what must happen. Generous, because the machine may be busy; nothing waits that
/// long unless something is wrong.
inline constexpr std::chrono::seconds kPatience{20};

/// Asks again and again. @return whether the condition came true, in time.
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
