/// @file The keys of simulated motion, the same in the simulator and in the drivers that simulate.
#pragma once

#include "common/config/config_reader.h"
#include "common/kinematics/kinematics.h"

namespace vismem {

/// Each reads the keys of its group over what `params` holds: those are the defaults. Problems stay in the
/// reader. The keys are explained in cfg/sim/simulator.cfg.
void readBaseParams(ConfigReader group, BaseParams& params);
void readPanTiltParams(ConfigReader group, PanTiltParams& params);
void readOdometryErrorParams(ConfigReader group, OdometryErrorParams& params);

}  // namespace vismem
