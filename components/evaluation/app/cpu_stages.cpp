#include "evaluation/app/cpu_stages.h"

#include <ctime>

namespace vismem {

double CpuStages::now_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void CpuStages::enter(const char* stage) {
  const double now = now_s();
  if (!current_.empty()) spent_s_[current_] += now - since_s_;
  current_ = stage;
  since_s_ = now;
}

std::map<std::string, double> CpuStages::seconds() {
  if (!current_.empty()) enter(std::string(current_).c_str());
  return spent_s_;
}

}  // namespace vismem
