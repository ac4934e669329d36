/// @file Random numbers that are equal with every standard library. Pure. See L6.
#pragma once

#include <cstdint>
#include <random>

namespace vismem {

using RandomEngine = std::mt19937_64;

/// Uniform in [low, high). std::uniform_real_distribution differs between standard libraries; runs must
/// repeat.
inline double uniform(RandomEngine& engine, double low, double high) {
  return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1.0p-53);
}

/// Uniform in 0..count-1.
/// @param count > 0.
inline std::size_t pick(RandomEngine& engine, std::size_t count) {
  return static_cast<std::size_t>(uniform(engine, 0.0, static_cast<double>(count)));
}

}  // namespace vismem
