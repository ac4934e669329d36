/// @file What the replays of a log have in common. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/recording/robot_log.h"
#include "common/robot/ports.h"

namespace vismem {

/// The answer to every command: a recording cannot be moved.
PortReply recordingCannotMove();

/// The range that was recorded; no speed.
PanTiltLimits limitsOf(const RobotLog& log);
FrameCapabilities capabilitiesOf(const RobotLog& log);
/// Accepted when the log has that size and the rate is left open; a rate is adjusted to the log's own.
PortReply configureFor(const RobotLog& log, const FrameRequest& request);

/// Number of samples up to and with the first at or past a stamp: what is needed to interpolate at it.
template <typename Sample>
std::size_t countToCover(const std::vector<Sample>& samples, StampUs stamp_us) {
  const auto covering = std::lower_bound(samples.begin(), samples.end(), stamp_us,
                                         [](const Sample& s, StampUs stamp) { return s.stamp_us < stamp; });
  return static_cast<std::size_t>(covering - samples.begin()) + (covering == samples.end() ? 0 : 1);
}

/// Index of the first sample past a stamp.
template <typename Sample>
std::size_t firstAfter(const std::vector<Sample>& samples, StampUs stamp_us) {
  return static_cast<std::size_t>(
      std::upper_bound(samples.begin(), samples.end(), stamp_us,
                       [](StampUs stamp, const Sample& s) { return stamp < s.stamp_us; }) -
      samples.begin());
}

}  // namespace vismem
