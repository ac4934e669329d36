/// @file The component gui_server: what its configuration means.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec guiServerSpec();

}  // namespace vismem
