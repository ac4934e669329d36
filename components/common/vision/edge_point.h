/// @file A sub-pixel edge point. Pure. See V1.
#pragma once

#include <cstdint>

namespace vismem {

/// Point of the largest gradient across an edge. Compact, because large images have more points than a cache
/// holds.
struct EdgePoint {
  /// From the lowest bit on: column (16 bits), row modulo 256 (8), whether it is steep (1), and how far it
  /// lies from that pixel, to the right if it is steep, else down (7, signed, in 1/100 px).
  std::uint32_t place = 0;
  std::int16_t gx = 0;  ///< gradient, see EdgeRowKernel
  std::int16_t gy = 0;

  /// Always inline: kernels for several processors use them.
  __attribute__((always_inline)) int column() const { return static_cast<int>(place & 0xffffU); }
  /// @param near a row less than 128 away.
  __attribute__((always_inline)) int row(int near) const {
    return near +
           static_cast<std::int8_t>(static_cast<std::uint8_t>(place >> 16) - static_cast<std::uint8_t>(near));
  }
  /// 1/100 px.
  __attribute__((always_inline)) int asideX() const { return steep() * aside(); }
  __attribute__((always_inline)) int asideY() const { return (1 - steep()) * aside(); }

 private:
  __attribute__((always_inline)) int steep() const { return static_cast<int>(place >> 24 & 1U); }
  __attribute__((always_inline)) int aside() const { return static_cast<std::int32_t>(place) >> 25; }
};
constexpr double kEdgePointUnit_px = 0.01;

}  // namespace vismem
