/// @file The process active_visual_memory: ports to its peers, the perception loop, its servants. See C2,
/// C3.
#pragma once

#include <memory>

#include "active_visual_memory/app/config.h"
#include "common/process/component.h"

namespace vismem {

/// @param config checked; the palette is read here.
/// @throws ConfigError when the palette is not usable.
std::unique_ptr<Component> makeActiveVisualMemory(const ActiveVisualMemoryConfig& config);

/// Name, keys' prefix and default endpoints; configure() reads the configuration.
ComponentSpec activeVisualMemorySpec();

}  // namespace vismem
