/// @file Watch of a device's steady stream of samples, for the status of its server. No Ice.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>

#include "common/process/metrics.h"

namespace vismem {

class StatusBoard;

/// Counts samples and reports a fault after `patience` without one. The status also watches the reading
/// thread, in case the driver hangs. *Single-threaded* (owner: the reader of the stream). The board must
/// outlive it.
class StreamHealth {
 public:
  /// @param stream name of the rate: "odometry".
  /// @param device name of the fault: "base".
  StreamHealth(StatusBoard& status, std::string stream, std::string device,
               std::chrono::milliseconds patience = std::chrono::seconds(1))
      : status_(status),
        stream_(std::move(stream)),
        device_(std::move(device)),
        reader_("reader of the " + device_),
        patience_(patience) {}

  /// @param condition abnormal condition of a device that still delivers: a fault while it lasts.
  void came(std::size_t count, SteadyTime now, const std::string& condition = {});
  /// @param why reason given by the device's driver.
  void nothing(const std::string& why, SteadyTime now);

 private:
  StatusBoard& status_;
  const std::string stream_;
  const std::string device_;
  const std::string reader_;
  const std::chrono::milliseconds patience_;
  SteadyTime last_{};
};

}  // namespace vismem
