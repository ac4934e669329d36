/// @file The process `gateway_access`: who may log in at the routers of a gateway, and what ends with a
/// session. See C1.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec gatewayAccessSpec();

}  // namespace vismem
