/// @file The process localization: the visual memory as a peer, the loop, what it serves. See C2, C3.
#pragma once

#include "common/process/component.h"

namespace vismem {

/// Name, keys' prefix and default endpoints; configure() reads the configuration.
ComponentSpec localizationSpec();

}  // namespace vismem
