/// @file CPU time of the stages of a run.
#pragma once

#include <map>
#include <string>

#include "common/profiling/stage_probe.h"

namespace vismem {

/// Adds up the CPU time of this thread by stage. *Single-threaded*.
class CpuStages : public StageProbe {
 public:
  void enter(const char* stage) override;
  /// Seconds by stage; the current stage counts up to now.
  std::map<std::string, double> seconds();
  /// CPU time of this thread so far.
  static double now_s();

 private:
  std::map<std::string, double> spent_s_;
  std::string current_;
  double since_s_ = 0.0;
};

}  // namespace vismem
