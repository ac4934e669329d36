/// @file The configuration keys of simulated motion, shared by the simulator and the simulated drivers.
#pragma once

#include "common/config/config_reader.h"
#include "common/kinematics/kinematics.h"

namespace vismem {

/// Each function reads the keys of its group; `params` holds the defaults. Problems stay in the reader.
/// cfg/sim/simulator.cfg explains the keys.
void readBaseParams(ConfigReader group, BaseParams& params);
void readPanTiltParams(ConfigReader group, PanTiltParams& params);
void readOdometryErrorParams(ConfigReader group, OdometryErrorParams& params);

}  // namespace vismem
