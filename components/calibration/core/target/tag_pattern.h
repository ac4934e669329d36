/// @file The black and white modules of a printed tag. Pure.
#pragma once

#include <array>

#include "calibration/core/board.h"

namespace vismem {

/// Modules of a tag with its black border, without the white ring around it.
struct TagPattern {
  static constexpr int kModules = 8;
  /// From the top row down, from left to right.
  std::array<std::array<bool, kModules>, kModules> black{};
};

/// @param id in [0, tagsOf(family)).
TagPattern tagPattern(TagFamily family, int id);

}  // namespace vismem
