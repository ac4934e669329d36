#include "common/vision/edge_rows.h"

namespace vismem {
namespace {

#include "common/vision/edge_rows_loops.inc"

int maximaLoop(const std::int16_t* const magnitude[3], const std::int16_t* gx, const std::int16_t* gy,
               int begin, int end, std::int16_t minimum, std::uint8_t* mask, std::uint16_t* columns) {
  maskLoop(magnitude, gx, gy, begin, end, minimum, mask);
  return listLoop(mask, begin, end, columns);
}

}  // namespace

#ifdef VISMEM_EDGE_ROWS_AVX2
const EdgeRowKernel& avx2EdgeRows();
#endif

const EdgeRowKernel& portableEdgeRows() {
  static constexpr EdgeRowKernel kKernel{"portable", grayLoop, columnsLoop, gradientLoop, maximaLoop};
  return kKernel;
}

const EdgeRowKernel& bestEdgeRows() {
#ifdef VISMEM_EDGE_ROWS_AVX2
  static const bool kAvx2 = __builtin_cpu_supports("avx2");
  if (kAvx2) return avx2EdgeRows();
#endif
  return portableEdgeRows();
}

}  // namespace vismem
