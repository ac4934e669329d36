/// @file Rows of edge points as bits, and the links between them. Pure. See V1.
#pragma once

#include <cstdint>

namespace vismem {

/// Words of zeros before and after each plane of a row, read by the search to both sides.
constexpr int kEdgeWordMargin = 4;

/// One row of an image, one bit per pixel. Planes other than `edge` are valid only where `edge` is set. A
/// point is *steep* if |gx| >= |gy|, else *flat*: its edge goes rather down than across.
struct EdgeBits {
  std::uint64_t* edge = nullptr;
  std::uint64_t* steep = nullptr;
  std::uint64_t* right = nullptr;          ///< gx > 0
  std::uint64_t* down = nullptr;           ///< gy > 0
  std::uint64_t* diagonal = nullptr;       ///< within 22 degrees of a diagonal
  std::uint64_t* free_next = nullptr;      ///< it has no successor yet
  std::uint64_t* free_previous = nullptr;  ///< it has no predecessor yet
};

/// Links from the points of a row to earlier points: to their left, or in a row above.
struct EdgeLinks {
  std::uint64_t* left = nullptr;
  std::uint64_t* above_left = nullptr;
  std::uint64_t* above = nullptr;
  std::uint64_t* above_right = nullptr;
};

/// Position of a point's predecessor in the list.
enum PreviousPoint : std::uint8_t { kNone, kEarlier, kLater };

/// Numbers of chain starts, and of possible ring starts, in a list of points.
struct EdgeChainEnds {
  int starts = 0;
  int tops = 0;
};

/// Numbers of the points at the columns of a row and of a row above, where there is one; readable for a
/// margin before.
struct EdgeColumns {
  const std::int32_t* here = nullptr;
  const std::int32_t* above = nullptr;
  int aside = 1;  ///< columns from a point to those linked with it to its left and right
};

/// Planes to work in, with margins.
struct EdgeWork {
  std::uint64_t* plane[10] = {};
};

}  // namespace vismem
