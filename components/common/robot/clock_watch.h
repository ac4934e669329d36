/// @file Check of a source's stamps against this host's clock. Pure: the host's time is passed in.
#pragma once

#include <optional>
#include <string>

#include "common/robot/samples.h"

namespace vismem {

/// Watches the stamps of one source. Only stamps near the host's time are compared: a simulation counts from
/// zero and a recording has its own date. *Single-threaded.*
class ClockWatch {
 public:
  /// @param stamp_us of the newest sample [us].
  /// @param host_now_us real time of this host [us].
  /// @return the problem: stamps with an offset over 0.3 s for 3 s; empty without one.
  std::string check(StampUs stamp_us, StampUs host_now_us);

 private:
  /// Host time since which the stamps are off. The delay covers a frozen process, which receives old samples
  /// for a moment.
  std::optional<StampUs> off_since_us_;
};

}  // namespace vismem
