/// @file Boxes in columns of numbers, which are compared many at a time. Pure; plain numbers only, see
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

/// A box, and the directions that are near enough: from the lowest one on, over the end of the turn.
struct BoxQuery {
  std::int16_t left, right, top, bottom;
  std::uint16_t lowest_angle, angle_span;
};

/// Lists those of the lanes begin..end-1 whose boxes meet another one, with a direction near its own.
/// @param lanes room for end - begin and a block. @return how many.
using ListMeetings = int (*)(const BoxLanes& boxes, const BoxQuery& query, int begin, int end,
                             std::int32_t* lanes);

}  // namespace vismem
