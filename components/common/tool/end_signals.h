/// @file Ctrl-C and SIGTERM as a question, for tools that end in their own order.
#pragma once

#include <signal.h>

#include <ctime>

namespace vismem {

/// Blocks both signals in this thread and those it starts: to be made before the first of them.
class EndSignals {
 public:
  EndSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM}) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// @return whether one came since the last call, or comes within this time.
  bool wait(double seconds) {
    const auto whole = static_cast<time_t>(seconds);
    const timespec limit{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
    return sigtimedwait(&set_, nullptr, &limit) > 0;
  }
  /// @return whether one came since the last call.
  bool arrived() { return wait(0.0); }

 private:
  sigset_t set_{};
};

}  // namespace vismem
