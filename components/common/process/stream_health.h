/// @file Whether what should come steadily from a device does come, for the status of its server. No Ice.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>

#include "common/process/metrics.h"

namespace vismem {

class StatusBoard;

/// Counts what comes and makes a fault of its absence: when nothing came for `patience`; and has the status
/// watch the thread that asks, should the device's driver hang. *Single-threaded* (owner: who reads the
/// stream). The board must outlive it.
class StreamHealth {
 public:
  /// @param stream counted under this name: "odometry". @param device for the fault: "base".
  StreamHealth(StatusBoard& status, std::string stream, std::string device,
               std::chrono::milliseconds patience = std::chrono::seconds(1))
      : status_(status),
        stream_(std::move(stream)),
        device_(std::move(device)),
        reader_("reader of the " + device_),
        patience_(patience) {}

  /// @param condition of a device that delivers and yet is not as it should be: a fault while it lasts.
  void came(std::size_t count, SteadyTime now, const std::string& condition = {});
  /// @param why what the device's driver says.
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
