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
  /// @return whether one came since the last call.
  bool arrived() {
    const timespec now{0, 0};
    return sigtimedwait(&set_, nullptr, &now) > 0;
  }

 private:
  sigset_t set_{};
};

}  // namespace vismem
