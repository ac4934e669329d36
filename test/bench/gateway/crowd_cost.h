/// @file What a crowd of viewers costs their router, and what an operator notices of it.
#pragma once

#include "bench/gateway/site.h"

namespace vismem {

/// Times of a small call every 20 ms [ms].
struct CallTimes {
  double median_ms = 0.0;
  double p99_ms = 0.0;
  double most_ms = 0.0;
};

struct CrowdCost {
  /// setVelocity through the operators' router, without and with the crowd.
  CallTimes operator_alone;
  CallTimes operator_beside;
  /// getInfo of the camera through the router that the crowd uses.
  CallTimes viewer_beside;
  double login_ms = 0.0;  ///< of one viewer, on average
  double rate_hz = 0.0;   ///< images of a viewer, on average
  double least_rate_hz = 0.0;
  double image_bytes = 0.0;
  /// Processor time in shares of one core: of the viewers' router, the operators' router, the simulated
  /// robot, and all viewers.
  double router = 0.0;
  double other_router = 0.0;
  double robot = 0.0;
  double viewers = 0.0;
};

/// @throw std::runtime_error if a viewer's session breaks.
CrowdCost measureCrowd(const Site& site, int viewers, double seconds);

}  // namespace vismem
