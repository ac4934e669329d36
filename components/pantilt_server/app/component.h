/// @file The process `pantilt_server`: a pan-tilt unit of any driver behind the robot's interface. See C1.
#pragma once

#include <functional>

#include "common/drivers/driver_registry.h"
#include "common/process/component.h"
#include "common/robot/ports.h"

namespace vismem {

/// @param more adds drivers to the built-in ones: those of a program outside the project. May be empty.
ComponentSpec panTiltServerSpec(std::function<void(DriverRegistry<PanTiltUnit>&)> more = {});

}  // namespace vismem
