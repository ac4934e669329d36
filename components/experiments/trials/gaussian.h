/// @file Normal random numbers, equal with every standard library (Box-Muller). Pure.
#pragma once

#include <cmath>
#include <numbers>

#include "localization/core/random_engine.h"

namespace vismem {

/// A normal random number of mean 0 and standard deviation 1.
inline double standardNormal(RandomEngine& engine) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(engine, 0.0, 1.0)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(engine, 0.0, 1.0));
}

}  // namespace vismem
