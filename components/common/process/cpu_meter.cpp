#include "common/process/cpu_meter.h"

#include <sys/resource.h>

namespace vismem {

void CpuMeter::add(SteadyTime now, double spent_s) {
  readings_.push_back({now, spent_s});
  // The reading just before the window stays: the share covers the whole window.
  while (readings_.size() > 2 && readings_[1].time <= now - window_) readings_.pop_front();
}

double CpuMeter::percent() const {
  if (readings_.size() < 2) return 0.0;
  const Reading& first = readings_.front();
  const Reading& last = readings_.back();
  const double elapsed_s = std::chrono::duration<double>(last.time - first.time).count();
  return elapsed_s > 0.0 ? 100.0 * (last.spent_s - first.spent_s) / elapsed_s : 0.0;
}

double processorTime_s() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace vismem
