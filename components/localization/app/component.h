/// @file The process localization: the visual memory as a peer, the loop, what it serves. See C2, C3.
#pragma once

#include <memory>

#include "common/process/component.h"
#include "localization/app/config.h"

namespace vismem {

/// @param config checked; map and palette are read here.
/// @throws ConfigError when one of them is not usable.
std::unique_ptr<Component> makeLocalization(const LocalizationConfig& config);

/// Name, keys' prefix and default endpoints; configure() reads the configuration.
ComponentSpec localizationSpec();

}  // namespace vismem
