/// @file Rounding of rates below the slowest rate of a device. Pure.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "common/geometry/angles.h"
#include "common/robot/ports.h"

namespace vismem {

/// A rate below the slowest becomes the slowest or 0, whichever is nearer; `reply` reports the change.
/// @param axis for the message: "pan".
/// @param slowest_radps > 0.
inline void atLeastSlowest(const char* axis, double slowest_radps, double& rate_radps, PortReply& reply) {
  if (rate_radps == 0.0 || std::abs(rate_radps) >= slowest_radps) return;
  const double nearest_radps =
      std::abs(rate_radps) < 0.5 * slowest_radps ? 0.0 : std::copysign(slowest_radps, rate_radps);
  std::ostringstream text;
  text << reply.message << (reply.message.empty() ? "" : ", ") << axis << " rate " << radToDeg(rate_radps)
       << " deg/s to " << radToDeg(nearest_radps) << " (the slowest is " << radToDeg(slowest_radps) << ")";
  reply = PortReply::adjusted(text.str());
  rate_radps = nearest_radps;
}

}  // namespace vismem
