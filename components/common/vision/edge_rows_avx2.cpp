// The same loops for x86-64 processors with AVX2 (compiled with -mavx2, called only where it is present).
#include <immintrin.h>

#include "common/vision/edge_rows.h"

namespace vismem {
namespace {

#include "common/vision/edge_rows_loops.inc"

int maximaLoop(const std::int16_t* const magnitude[3], const std::int16_t* gx, const std::int16_t* gy,
               int begin, int end, std::int16_t minimum, std::uint8_t* mask, std::uint16_t* columns) {
  maskLoop(magnitude, gx, gy, begin, end, minimum, mask);
  int count = 0;
  int x = begin;
  for (; x + 32 <= end; x += 32) {
    const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(mask + x));
    for (auto bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes)); bits != 0; bits &= bits - 1) {
      columns[count++] = static_cast<std::uint16_t>(x + __builtin_ctz(bits));
    }
  }
  return count + listLoop(mask, x, end, columns + count);
}

}  // namespace

const EdgeRowKernel& avx2EdgeRows();
const EdgeRowKernel& avx2EdgeRows() {
  static constexpr EdgeRowKernel kKernel{"avx2", grayLoop, columnsLoop, gradientLoop, maximaLoop};
  return kKernel;
}

}  // namespace vismem
