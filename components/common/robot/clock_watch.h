/// @file Whether a source's stamps agree with this host's clock (DESIGN 14). Pure: the host's time is passed
/// in.
#pragma once

#include <optional>
#include <string>

#include "common/robot/samples.h"

namespace vismem {

/// Watches the stamps of one source. Only stamps near the host's time are compared: a simulation counts from
/// zero and a recording has its own date. *Single-threaded.*
class ClockWatch {
 public:
  /// @param stamp_us     of the newest sample. @param host_now_us  real time of this host.
  /// @return what is wrong: stamps that have been over a second off for some seconds; empty if nothing is.
  std::string check(StampUs stamp_us, StampUs host_now_us);

 private:
  /// Since when the stamps are off, in the host's time. A process that was frozen gets old samples for a
  /// moment.
  std::optional<StampUs> off_since_us_;
};

}  // namespace vismem
