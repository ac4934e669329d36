/// @file Boxes as columns of numbers, for the comparison of many at a time. Pure; plain numbers only, see
/// line_run_kernel.h.
#pragma once

#include <cstdint>

namespace vismem {

/// Columns of boxes about directed segments [px], readable for a block beyond the last box.
struct BoxLanes {
  const std::int16_t* left = nullptr;
  const std::int16_t* right = nullptr;
  const std::int16_t* top = nullptr;
  const std::int16_t* bottom = nullptr;
  const std::uint16_t* angle = nullptr;  ///< of the direction; wraps
};
constexpr int kBoxBlock = 32;

/// A box with an interval of directions; the interval may wrap.
struct BoxQuery {
  std::int16_t left, right, top, bottom;
  std::uint16_t lowest_angle, angle_span;
};

/// Lists the lanes of begin..end-1 whose boxes overlap the query's box and whose directions lie in its
/// interval.
/// @param lanes room for end - begin and a block.
/// @return their number.
using ListOverlaps = int (*)(const BoxLanes& boxes, const BoxQuery& query, int begin, int end,
                             std::int32_t* lanes);

}  // namespace vismem
