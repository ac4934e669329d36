/// @file The process `base_server`: a mobile base of any driver behind the robot's interfaces. See C1.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec baseServerSpec();

}  // namespace vismem
