/// @file The built-in camera drivers.
#pragma once

#include "common/drivers/driver_registry.h"
#include "common/robot/ports.h"

namespace vismem {

void registerCameraDrivers(DriverRegistry<FrameSource>& registry);

}  // namespace vismem
