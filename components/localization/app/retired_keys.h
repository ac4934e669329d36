/// @file Keys of earlier releases that have no effect any more. Pure. See C2.
#pragma once

#include "common/config/config_reader.h"

namespace vismem {

/// Accepts the removed keys of localization, each with a warning that says what became of it.
/// @param reader at the prefix "Localization".
void acceptRetiredLocalizationKeys(ConfigReader& reader);

}  // namespace vismem
