/// @file When labels of segments agree. Pure. See V3.
#pragma once

#include "common/vision/image_segment.h"

namespace vismem {

/// True if both labels may name one thing: they are equal, or at least one is unknown.
inline bool labelsCompatible(const Label& a, const Label& b) {
  return a == b || a == kUnknownLabel || b == kUnknownLabel;
}

}  // namespace vismem
