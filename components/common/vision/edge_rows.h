/// @file The dense part of the detector, row by row: every implementation gives the same bits. Pure. See V1.
#pragma once

#include <cstdint>
#include <vector>

#include "common/vision/box_lanes.h"
#include "common/vision/edge_bits.h"
#include "common/vision/edge_point.h"
#include "common/vision/line_run_kernel.h"

namespace vismem {

/// Values beyond both ends of a row of `smooth` and `difference` that `gradient` reads.
constexpr int kEdgeRowMargin = 2;
/// Rows of gradients and magnitudes are readable (not more) so many values before their first one, and to the
/// end of the last word of planes and so many beyond.
constexpr int kEdgeReadMargin = 16;
/// Number of columns in one block: a list of columns must be readable that far beyond its end.
constexpr int kEdgePointBlock = 16;

/// The selected points of a row.
struct EdgeRowPoints {
  EdgeBits bits;
  int words = 0;
  const std::uint16_t* columns = nullptr;  ///< readable for a block more: columns of the image
  int count = 0;
  int y = 0;
  std::int32_t* work = nullptr;  ///< room for four rows of 64 * words and a block each
};

/// Steps from rows of an image to linked edge points. The gradient is that of the image smoothed by a
/// binomial 3x3, by Sobel: [1 4 6 4 1] along the edge times [-1 -2 0 2 1] across it, |gx| and |gy| up to 12
/// 240.
struct EdgeRowKernel {
  const char* name;
  int word_block;  ///< planes have a multiple of so many words
  /// Brightness of R, G, B pixels with the weights of ITU-R BT.601.
  void (*gray)(const std::uint8_t* rgb, int width, std::uint8_t* gray);
  /// The largest of R, G and B.
  void (*strongest)(const std::uint8_t* rgb, int width, std::uint8_t* most);
  /// Five rows of the image, top to bottom -> smoothed and differentiated down the columns.
  void (*columns)(const std::uint8_t* const rows[5], int width, std::int16_t* smooth,
                  std::int16_t* difference);
  /// -> gradient (pairs of gx, gy), its length (within 3 per cent: the larger component and half of the
  /// smaller one) and bits of its direction.
  void (*gradient)(const std::int16_t* smooth, const std::int16_t* difference, int width,
                   std::int16_t* gradient, std::int16_t* magnitude, std::int16_t* kind);
  /// Marks the columns in begin..end-1 where the magnitude (rows above, here, below) is at least `minimum`
  /// and the largest along the axis nearest to the gradient: one point per row of a steep edge and per column
  /// of a flat one.
  /// @param mask  work space of 64 * words bytes, 0 outside begin..end-1.
  /// @param words of the planes of `out` but the free ends, written.
  void (*maxima)(const std::int16_t* const magnitude[3], const std::int16_t* kind, int begin, int end,
                 std::int16_t minimum, std::uint8_t* mask, int words, const EdgeBits& out);
  /// Lists the columns of a row's points, and numbers them from `first` on.
  /// @param columns room for a row and a block.
  /// @param index of each column with a point; others are undefined.
  /// @return their number.
  int (*list)(const std::uint64_t* edge, int words, std::int32_t first, std::uint16_t* columns,
              std::int32_t* index);
  /// The points of row y, from the gradients above, here and below.
  /// @param points has room for two blocks more.
  void (*points)(const std::int16_t* const gradient[3], const EdgeRowPoints& row, EdgePoint* points);
  /// Links points with their neighbours in the row and in the row above, if both ends are free and the
  /// directions agree.
  /// @param words a multiple of word_block.
  void (*link)(const EdgeBits& here, const EdgeBits& above, int words, const EdgeWork& work,
               const EdgeLinks& links);
  /// Lists the links of a row as pairs of points, the brighter side on the left.
  /// @param from, to room for two rows.
  /// @return their number.
  int (*list_links)(const EdgeBits& here, const EdgeLinks& links, int words, const EdgeColumns& columns,
                    std::int32_t* from, std::int32_t* to);
  /// Links over one missing point;
  /// @return whether there is any. Steep edge: to the row two above, at most one column aside.
  bool (*bridge_steep)(const EdgeBits& here, const EdgeBits& above, int words, const EdgeWork& work,
                       const EdgeLinks& links);
  /// Flat edge: two columns aside, in its row or to the row above.
  bool (*bridge_flat)(const EdgeBits& here, const EdgeBits& above, int words, const EdgeWork& work,
                      const EdgeLinks& links);
  /// Diagonal edge: two columns aside in the row two above.
  bool (*bridge_diagonal)(const EdgeBits& here, const EdgeBits& above, int words, const EdgeWork& work,
                          const EdgeLinks& links);
  /// See EdgePointFinder::listStarts. `next` and `previous` are readable for two blocks more.
  EdgeChainEnds (*starts)(const std::int16_t* next, const std::uint8_t* previous, int count,
                          std::int32_t* starts, std::int32_t* tops);
  /// See LineRunFinder.
  FindLineRuns runs;
  /// See CollinearMerger.
  ListOverlaps overlaps;
};

/// The implementation for any processor.
const EdgeRowKernel& portableEdgeRows();
/// All implementations for this processor, the fastest last.
std::vector<const EdgeRowKernel*> edgeRowKernels();
/// The fastest implementation for this processor; selected once.
const EdgeRowKernel& bestEdgeRows();

}  // namespace vismem
