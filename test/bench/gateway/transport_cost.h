/// @file What TLS and the gateway cost beside plain tcp.
#pragma once

#include <string>
#include <vector>

#include "bench/gateway/site.h"

namespace vismem {

/// Of a call that returns an RGB image.
struct TransportCost {
  std::string name;           ///< "tcp", "ssl", "gateway"
  double median_us = 0.0;     ///< of the round trip
  double processor_us = 0.0;  ///< of client, robot and router together
  double median_ratio = 0.0;  ///< to tcp in the same run
  double processor_ratio = 0.0;
};

/// Asks the three ways in turns, so that other work on the machine meets all alike. @param rounds of 20
/// calls.
std::vector<TransportCost> measureTransports(const Site& site, int rounds);

}  // namespace vismem
