/// @file Numbers as people read them. Pure.
#pragma once

#include <cmath>

namespace vismem {

/// To the nearest 1 / parts; never -0.
inline double rounded(double value, double parts) {
  return std::round(value * parts) / parts + 0.0;
}

}  // namespace vismem
