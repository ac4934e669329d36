/// @file Limits of commands: one rule with the same messages for every driver, the simulator and the
/// servants. Pure.
#pragma once

#include "common/robot/ports.h"

namespace vismem {

struct LimitedPanTiltCommand {
  /// The command to execute if `reply` is ok: finite and within the limits.
  PanTiltCommand command;
  PortReply reply;
};

/// Rejected: a value that is not finite; a negative bound of a rate. Adjusted, with both values in the
/// message: angles and signed rates outside the limits. A rate bound above the maximum becomes the maximum,
/// as 0 does; this is no adjustment.
LimitedPanTiltCommand limitCommand(const PanTiltLimits& limits, const PanTiltCommand& command);

struct LimitedVelocity {
  double v_mps = 0.0;
  double w_radps = 0.0;
  PortReply reply;
};

/// Rejected: a value that is not finite. Adjusted: speeds above the limits.
LimitedVelocity limitVelocity(const BaseLimits& limits, double v_mps, double w_radps);

}  // namespace vismem
