/// @file The process mapper: memory and camera as peers, the record of the drive, maps of it. See B6, C2, C3.
#pragma once

#include "common/process/component.h"

namespace vismem {

/// Name, keys' prefix and default endpoints; configure() reads the configuration.
ComponentSpec mapperSpec();

}  // namespace vismem
