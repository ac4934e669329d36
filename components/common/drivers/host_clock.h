/// @file The clock of the stamps of devices.
#pragma once

#include <chrono>

#include "common/robot/samples.h"

namespace vismem {

/// The host's CLOCK_REALTIME [us]. It may be set back; SampleBuffer defines the consequences for samples.
inline StampUs hostClock_us() {
  // system_clock is CLOCK_REALTIME on Linux.
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace vismem
