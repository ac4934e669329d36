/// @file The process `base_server`: a mobile base of any driver behind the robot's interfaces. See C1.
#pragma once

#include <functional>

#include "common/drivers/driver_registry.h"
#include "common/process/component.h"
#include "common/robot/ports.h"

namespace vismem {

/// @param more adds drivers to the built-in ones: those of a program outside the project. May be empty.
ComponentSpec baseServerSpec(std::function<void(DriverRegistry<MobileBase>&)> more = {});

}  // namespace vismem
