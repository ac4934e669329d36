/// @file Processor time of whole processes.
#pragma once

#include <sys/types.h>
#include <time.h>

#include <stdexcept>
#include <string>

namespace vismem {

/// All threads of a process since its start [s], those that have ended too.
inline double processorTime_s(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0)
    throw std::runtime_error("no processor time of process " + std::to_string(process));
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace vismem
