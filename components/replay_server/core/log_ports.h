/// @file Functions shared by the replays of a log. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/recording/robot_log.h"
#include "common/robot/ports.h"

namespace vismem {

/// The answer to a command that makes sense: taken and ignored, with a notice, so that whoever steers a robot
/// works on its recording too. Rejected when its values are not finite.
PortReply ignored(const PanTiltCommand& command);
PortReply ignoredVelocity(double v_mps, double w_radps);

/// Limits from the recorded range of angles; no speeds.
PanTiltLimits limitsOf(const RobotLog& log);
FrameCapabilities capabilitiesOf(const RobotLog& log);
/// Accepted for the log's image size without a rate; a rate is adjusted to that of the log.
PortReply configureFor(const RobotLog& log, const FrameRequest& request);

/// Number of samples up to and including the first at or past a stamp, as needed for an interpolation at it.
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
