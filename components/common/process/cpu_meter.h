/// @file How much of a processor core the process uses. Pure: both times are passed in.
#pragma once

#include <chrono>
#include <deque>

#include "common/process/metrics.h"

namespace vismem {

/// Share of a core over the last seconds. *Single-threaded* (owner: the main thread).
class CpuMeter {
 public:
  explicit CpuMeter(std::chrono::milliseconds window = std::chrono::seconds(3)) : window_(window) {}

  /// Takes a reading. @param spent_s processor time of the process since its start, user and system [s].
  void add(SteadyTime now, double spent_s);
  /// Of one core [%], from the oldest reading of the window to the newest; 0 before the second reading.
  double percent() const;

 private:
  struct Reading {
    SteadyTime time;
    double spent_s = 0.0;
  };
  std::chrono::nanoseconds window_;
  std::deque<Reading> readings_;
};

/// Processor time of this process since its start, user and system [s].
double processorTime_s();

}  // namespace vismem
