/// @file The dense part of the detector, row by row, on integers only: every implementation gives the same
/// bits. Pure. SPEC V1.
#pragma once

#include <cstdint>

namespace vismem {

/// Values beyond both ends of a row of `smooth` and `difference` that `gradient` reads.
constexpr int kEdgeRowMargin = 2;

/// Steps from rows of an image to edge points. The gradient is that of the image smoothed by a binomial 3x3,
/// by Sobel: [1 4 6 4 1] along the edge times [-1 -2 0 2 1] across it, |gx| and |gy| up to 12 240.
struct EdgeRowKernel {
  const char* name;
  /// Brightness of R, G, B pixels with the weights of ITU-R BT.601.
  void (*gray)(const std::uint8_t* rgb, int width, std::uint8_t* gray);
  /// Five rows of the image, top to bottom -> smoothed and differentiated down the columns.
  void (*columns)(const std::uint8_t* const rows[5], int width, std::int16_t* smooth,
                  std::int16_t* difference);
  /// -> gradient and its length (within 3 per cent: the larger component and half of the smaller one).
  void (*gradient)(const std::int16_t* smooth, const std::int16_t* difference, int width, std::int16_t* gx,
                   std::int16_t* gy, std::int16_t* magnitude);
  /// Columns in begin..end-1 where the magnitude (rows above, here, below) is at least `minimum` and the
  /// largest along the axis nearest to the gradient: one point per row of a steep edge and per column of a
  /// flat one.
  /// @param mask    work space of `width` bytes.
  /// @param columns room for end - begin. @return how many.
  int (*maxima)(const std::int16_t* const magnitude[3], const std::int16_t* gx, const std::int16_t* gy,
                int begin, int end, std::int16_t minimum, std::uint8_t* mask, std::uint16_t* columns);
};

/// For any processor.
const EdgeRowKernel& portableEdgeRows();
/// The fastest one that this processor runs; chosen once.
const EdgeRowKernel& bestEdgeRows();

}  // namespace vismem
