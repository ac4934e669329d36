/// @file The camera drivers that are built in.
#pragma once

#include "common/drivers/driver_registry.h"
#include "common/robot/ports.h"

namespace vismem {

void registerCameraDrivers(DriverRegistry<FrameSource>& registry);

}  // namespace vismem
