/// @file Configuration of replay_server: every key, checked once at start.
#pragma once

#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/recording/robot_log.h"
#include "replay_server/app/log_player.h"

namespace vismem {

/// See C2. All keys begin with "ReplayServer."; the table is in the component's README.
struct ReplayServerConfig {
  std::vector<std::string> files;  ///< bags, or folders with the parts of one
  RobotLogOptions log;
  LogPlayer::Params player;
};

/// @param reader at the prefix "ReplayServer". Problems are collected in it; the caller finishes it.
ReplayServerConfig readReplayServerConfig(ConfigReader& reader);

}  // namespace vismem
