/// @file The process `replay_server`: a recording behind the interfaces of a robot. See C1, C2.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec replayServerSpec();

}  // namespace vismem
