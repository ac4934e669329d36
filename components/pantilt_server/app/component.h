/// @file The process `pantilt_server`: a pan-tilt unit of any driver behind the robot's interface. See C1.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec panTiltServerSpec();

}  // namespace vismem
