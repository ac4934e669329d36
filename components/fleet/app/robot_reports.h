/// @file The report of a robot out of the answers of its components.
#pragma once

#include <avm/fleet.h>
#include <avm/localization.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/process/status_client.h"

namespace vismem {

/// Numbers the reports and knows how old the estimate is. Pure. *Single-threaded*.
class RobotReports {
 public:
  /// An estimate that does not change for longer is no pose: its localization is frozen.
  static constexpr std::chrono::milliseconds kFresh{1000};

  explicit RobotReports(std::string robot) : robot_(std::move(robot)) {}

  /// @param estimate empty: localization does not answer.
  /// @param parts answers of the components by name.
  avm::RobotReport next(const std::optional<avm::PoseEstimate>& estimate,
                        const std::map<std::string, StatusAnswer>& parts, std::int64_t host_us,
                        std::chrono::steady_clock::time_point now);

 private:
  const std::string robot_;
  std::int64_t number_ = 0;
  std::int64_t revision_ = -1;
  std::chrono::steady_clock::time_point changed_;
};

}  // namespace vismem
