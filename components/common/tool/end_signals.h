/// @file Ctrl-C and SIGTERM as a question, for programs that end in their own order.
#pragma once

#include <signal.h>

#include <ctime>
#include <initializer_list>

namespace vismem {

/// Blocks the signals in this thread and those it starts: to be made before the first of them.
class EndSignals {
 public:
  explicit EndSignals(std::initializer_list<int> numbers = {SIGINT, SIGTERM}) {
    sigemptyset(&set_);
    for (const int number : numbers) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// @return whether one came, or comes within this time.
  bool wait(double seconds) {
    const auto whole = static_cast<time_t>(seconds);
    const timespec limit{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
    arrived_ = arrived_ || sigtimedwait(&set_, nullptr, &limit) > 0;
    return arrived_;
  }
  bool arrived() { return wait(0.0); }

 private:
  sigset_t set_{};
  bool arrived_ = false;
};

}  // namespace vismem
