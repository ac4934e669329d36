/// @file The process `simulator`: the simulated robot behind the same interfaces as a real one. See C1, C2.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec simulatorSpec();

}  // namespace vismem
