/// @file A thread that calls a function periodically.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace vismem {

/// Calls `work` once a period, on one thread. Missed periods (a busy machine, a frozen process) are skipped;
/// `work` measures the elapsed time itself. *Thread-safe*; never stop it from `work`.
class PeriodicThread {
 public:
  using Clock = std::chrono::steady_clock;

  ~PeriodicThread() { stop(); }

  /// Starts the thread, unless it runs already. The first call follows at once.
  void start(Clock::duration period, std::function<void()> work) {
    const std::lock_guard lock(control_);
    if (thread_.joinable()) return;
    thread_ = std::jthread([this, period, work = std::move(work)](const std::stop_token& stop) {
      auto next = Clock::now();
      while (!stop.stop_requested()) {
        work();
        next = std::max(next + period, Clock::now());
        std::unique_lock pause(pause_mutex_);
        pause_.wait_until(pause, stop, next, [] { return false; });
      }
    });
  }

  /// Returns after the end of the last call.
  void stop() {
    const std::lock_guard lock(control_);
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
  }

 private:
  std::mutex control_;
  std::mutex pause_mutex_;
  std::condition_variable_any pause_;
  std::jthread thread_;
};

}  // namespace vismem
