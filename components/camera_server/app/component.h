/// @file The process `camera_server`: cameras behind avm::Camera and jderobot::Camera. See C1, C2.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec cameraServerSpec();

}  // namespace vismem
