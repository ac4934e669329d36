/// @file Configuration of the agent.
#pragma once

#include <map>
#include <string>

#include "common/config/config_reader.h"

namespace vismem {

struct FleetAgentConfig {
  std::string robot;                         ///< its name at the site
  std::string localization;                  ///< proxy; empty: no poses
  std::map<std::string, std::string> parts;  ///< proxies of avm::Component by name
  std::string topics;                        ///< proxy of the topic manager; empty: nothing is published
  std::string topic;
  double rate_hz = 2.0;
};

/// Reads the keys FleetAgent.*.
FleetAgentConfig readFleetAgentConfig(ConfigReader& root);

}  // namespace vismem
