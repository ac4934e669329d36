/// @file The keys of a component's process, in a file that another program reads for its parameters. Pure.
#pragma once

#include <string>

#include "common/config/config_reader.h"

namespace vismem {

/// Accepts Robot.* and the keys of readProcessKeys without reading them.
/// @param prefix of the component: "Localization".
void knowProcessKeys(ConfigReader& root, const std::string& prefix);

}  // namespace vismem
