/// @file Rows of edge points as bits, and the links between them. Pure. SPEC V1.
#pragma once

#include <cstdint>

namespace vismem {

/// Words of zeros before and after each plane of a row, which looking sideways reads.
constexpr int kEdgeWordMargin = 4;

/// One row of an image, a bit a pixel. Planes other than `edge` mean something only where that is set. A
/// point is *steep* if |gx| >= |gy|, else *flat*: its edge goes rather down than across.
struct EdgeBits {
  std::uint64_t* edge = nullptr;
  std::uint64_t* steep = nullptr;
  std::uint64_t* right = nullptr;          ///< gx > 0
  std::uint64_t* down = nullptr;           ///< gy > 0
  std::uint64_t* diagonal = nullptr;       ///< within 22 degrees of a diagonal
  std::uint64_t* free_next = nullptr;      ///< no other one follows yet
  std::uint64_t* free_previous = nullptr;  ///< it follows no other one yet
};

/// Which points of a row were linked to which earlier ones: to their left, or in a row above.
struct EdgeLinks {
  std::uint64_t* left = nullptr;
  std::uint64_t* above_left = nullptr;
  std::uint64_t* above = nullptr;
  std::uint64_t* above_right = nullptr;
};

/// Where in the list of points the one is that a point follows.
enum PreviousPoint : std::uint8_t { kNone, kEarlier, kLater };

/// How many points of a list begin chains, and how many may begin rings.
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
