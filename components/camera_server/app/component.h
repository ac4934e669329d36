/// @file The process `camera_server`: cameras behind avm::Camera and jderobot::Camera. See C1, C2.
#pragma once

#include <functional>

#include "common/drivers/driver_registry.h"
#include "common/process/component.h"
#include "common/robot/ports.h"

namespace vismem {

/// @param more adds drivers to the built-in ones: those of a program outside the project. May be empty.
ComponentSpec cameraServerSpec(std::function<void(DriverRegistry<FrameSource>&)> more = {});

}  // namespace vismem
