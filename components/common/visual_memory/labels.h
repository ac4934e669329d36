/// @file When labels of segments agree. Pure. See V3.
#pragma once

#include <string_view>

#include "common/vision/image_segment.h"

namespace vismem {

/// True if both labels may name one thing: they are equal, or at least one is unknown.
inline bool labelsCompatible(std::string_view a, std::string_view b) {
  return a == b || a == kUnknownLabel || b == kUnknownLabel;
}

}  // namespace vismem
