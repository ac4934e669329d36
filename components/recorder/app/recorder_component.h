/// @file The process `recorder`: everything that the components publish, in bags. See C1.
#pragma once

#include "common/process/component.h"

namespace vismem {

ComponentSpec recorderSpec();

}  // namespace vismem
