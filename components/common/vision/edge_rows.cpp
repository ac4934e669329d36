#include "common/vision/edge_rows.h"

namespace vismem {
namespace {
#include "common/vision/box_lanes.inc"
#include "common/vision/edge_links.inc"
#include "common/vision/edge_rows_loops.inc"
#include "common/vision/line_runs.inc"

/// Eight bytes of a mask, one bit of each, in order.
std::uint64_t eightBits(std::uint64_t bytes, int bit) {
  return ((bytes >> bit & 0x0101010101010101U) * 0x0102040810204080U) >> 56;
}

void bitsLoop(const std::uint8_t* mask, int words, const EdgeBits& out) {
  std::uint64_t* const planes[] = {out.edge, out.steep, out.right, out.down, out.diagonal};
  for (int word = 0; word < words; ++word) {
    std::uint64_t bits[5] = {};
    for (int k = 0; k < 8; ++k) {
      std::uint64_t bytes = 0;
      for (int j = 0; j < 8; ++j) bytes |= static_cast<std::uint64_t>(mask[64 * word + 8 * k + j]) << (8 * j);
      if (bytes == 0) continue;
      for (int plane = 0; plane < 5; ++plane) bits[plane] |= eightBits(bytes, plane) << (8 * k);
    }
    for (int plane = 0; plane < 5; ++plane) planes[plane][word] = bits[plane];
  }
}

void pointsLoop(const std::int16_t* const gradient[3], const EdgeRowPoints& row, EdgePoint* points) {
  const std::int16_t* above = gradient[0];
  const std::int16_t* here = gradient[1];
  const std::int16_t* below = gradient[2];
  for (int k = 0; k < row.count; ++k) {
    const int x = row.columns[k];
    const int u = here[2 * x];
    const int v = here[2 * x + 1];
    const bool steep = (u < 0 ? -u : u) >= (v < 0 ? -v : v);
    const std::int16_t* before_at = steep ? here + 2 * (x - 1) : above + 2 * x;
    const std::int16_t* after_at = steep ? here + 2 * (x + 1) : below + 2 * x;
    // Top of the parabola through what the three gradients have in the direction of the middle one. Each
    // product is at most 2 * 12240^2: the sums fit.
    const int squared = u * u + v * v;
    const int before = u * before_at[0] + v * before_at[1];
    const int after = u * after_at[0] + v * after_at[1];
    const int sum = (squared - before) + (squared - after);
    const int curvature = sum > 1 ? sum : 1;
    float offset = 0.5F * static_cast<float>(after - before) / static_cast<float>(curvature);
    offset = offset > -kMaximumOffset_px ? offset : -kMaximumOffset_px;
    offset = offset < kMaximumOffset_px ? offset : kMaximumOffset_px;
    EdgePoint& point = points[k];
    const int aside =
        static_cast<int>(offset * kOffsetUnits + (static_cast<float>(kOffsetZero) + 0.5F)) - kOffsetZero;
    point.place = static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(row.y & 255) << 16 |
                  static_cast<std::uint32_t>(steep) << 24 | static_cast<std::uint32_t>(aside) << 25;
    point.gx = static_cast<std::int16_t>(u);
    point.gy = static_cast<std::int16_t>(v);
  }
}

void maximaLoop(const std::int16_t* const magnitude[3], const std::int16_t* kind, int begin, int end,
                std::int16_t minimum, std::uint8_t* mask, int words, const EdgeBits& out) {
  maskLoop(magnitude, kind, begin, end, minimum, mask);
  bitsLoop(mask, words, out);
}

}  // namespace

#ifdef VISMEM_EDGE_ROWS_X86
const EdgeRowKernel& avx2EdgeRows();
const EdgeRowKernel& avx512EdgeRows();
#endif

const EdgeRowKernel& portableEdgeRows() {
  static constexpr EdgeRowKernel kKernel{
      "portable",     kWordBlock,         grayLoop,   strongestLoop, columnsLoop,   gradientLoop,
      maximaLoop,     listLoop,           pointsLoop, linkLoop,      listLinksLoop, bridgeSteepLoop,
      bridgeFlatLoop, bridgeDiagonalLoop, startsLoop, findRuns,      overlapsLoop};
  return kKernel;
}

std::vector<const EdgeRowKernel*> edgeRowKernels() {
  std::vector<const EdgeRowKernel*> kernels{&portableEdgeRows()};
#ifdef VISMEM_EDGE_ROWS_X86
  if (__builtin_cpu_supports("avx2")) kernels.push_back(&avx2EdgeRows());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(&avx512EdgeRows());
  }
#endif
  return kernels;
}

const EdgeRowKernel& bestEdgeRows() {
  static const EdgeRowKernel& best = *edgeRowKernels().back();
  return best;
}

}  // namespace vismem
