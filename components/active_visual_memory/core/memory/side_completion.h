/// @file The segments that lie on one side of a shape. Pure. See M9.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// A side of a published shape that consists of several remembered segments: they are to be joined.
struct SideCompletion {
  Segment2 side;                        ///< from corner to corner
  std::vector<std::uint64_t> segments;  ///< the pieces on it, sorted
};

}  // namespace vismem
