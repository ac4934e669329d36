/// @file The robot's agent at its site.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec fleetAgentSpec();

}  // namespace vismem
