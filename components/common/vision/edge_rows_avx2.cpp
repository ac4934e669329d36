// The same loops for x86-64 processors with AVX2 (compiled with -mavx2, called only where it is present).
#include <immintrin.h>

#include "common/vision/edge_rows.h"

namespace vismem {
namespace {
#include "common/vision/box_lanes.inc"
#include "common/vision/edge_links.inc"
#include "common/vision/edge_rows_loops.inc"
#include "common/vision/line_runs.inc"

void maximaLoop(const std::int16_t* const magnitude[3], const std::int16_t* kind, int begin, int end,
                std::int16_t minimum, std::uint8_t* mask, int words, const EdgeBits& out) {
  maskLoop(magnitude, kind, begin, end, minimum, mask);
  std::uint64_t* const planes[] = {out.edge, out.steep, out.right, out.down, out.diagonal};
  for (int word = 0; word < words; ++word) {
    const auto* bytes = reinterpret_cast<const __m256i*>(mask + 64 * word);
    const __m256i low = _mm256_loadu_si256(bytes);
    const __m256i high = _mm256_loadu_si256(bytes + 1);
    // The bit of a plane goes to the top of its byte; what crosses from the byte below does not reach it.
    const auto plane = [&](int shift) {
      const auto low_bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_slli_epi16(low, shift)));
      const auto high_bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_slli_epi16(high, shift)));
      return static_cast<std::uint64_t>(high_bits) << 32 | low_bits;
    };
    for (int k = 0; k < 5; ++k) planes[k][word] = plane(7 - k);
  }
}

/// Eight points at a time.
void pointsLoop(const std::int16_t* const gradient[3], const EdgeRowPoints& row, EdgePoint* points) {
  constexpr int kEight = 8;
  const auto* here = reinterpret_cast<const int*>(gradient[1]);
  const auto up = static_cast<int>((gradient[0] - gradient[1]) / 2);
  const auto down = static_cast<int>((gradient[2] - gradient[1]) / 2);
  const __m256i y = _mm256_set1_epi32((row.y & 255) << 16);
  const __m256i steep_bit = _mm256_set1_epi32(1 << 24);
  const __m256 limit = _mm256_set1_ps(kMaximumOffset_px);
  for (int k = 0; k < row.count; k += kEight) {
    const __m256i x =
        _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(row.columns + k)));
    const __m256i middle = _mm256_i32gather_epi32(here, x, 4);
    const __m256i size = _mm256_abs_epi16(middle);
    const __m256i flat =
        _mm256_cmpgt_epi32(_mm256_srli_epi32(size, 16), _mm256_and_si256(size, _mm256_set1_epi32(0xffff)));
    const __m256i before_at =
        _mm256_add_epi32(x, _mm256_blendv_epi8(_mm256_set1_epi32(-1), _mm256_set1_epi32(up), flat));
    const __m256i after_at =
        _mm256_add_epi32(x, _mm256_blendv_epi8(_mm256_set1_epi32(1), _mm256_set1_epi32(down), flat));
    const __m256i squared = _mm256_madd_epi16(middle, middle);
    const __m256i before = _mm256_madd_epi16(middle, _mm256_i32gather_epi32(here, before_at, 4));
    const __m256i after = _mm256_madd_epi16(middle, _mm256_i32gather_epi32(here, after_at, 4));
    const __m256i sum = _mm256_add_epi32(_mm256_sub_epi32(squared, before), _mm256_sub_epi32(squared, after));
    const __m256 curvature = _mm256_cvtepi32_ps(_mm256_max_epi32(sum, _mm256_set1_epi32(1)));
    const __m256 skew = _mm256_cvtepi32_ps(_mm256_sub_epi32(after, before));
    __m256 offset = _mm256_div_ps(_mm256_mul_ps(_mm256_set1_ps(0.5F), skew), curvature);
    offset = _mm256_max_ps(offset, _mm256_sub_ps(_mm256_setzero_ps(), limit));
    offset = _mm256_min_ps(offset, limit);
    const __m256i aside = _mm256_sub_epi32(
        _mm256_cvttps_epi32(_mm256_add_ps(_mm256_mul_ps(offset, _mm256_set1_ps(kOffsetUnits)),
                                          _mm256_set1_ps(static_cast<float>(kOffsetZero) + 0.5F))),
        _mm256_set1_epi32(kOffsetZero));
    const __m256i place =
        _mm256_or_si256(_mm256_or_si256(_mm256_or_si256(x, y), _mm256_slli_epi32(aside, 25)),
                        _mm256_andnot_si256(flat, steep_bit));
    // From columns of numbers to points.
    const __m256i low = _mm256_unpacklo_epi32(place, middle);   // points 0 1 4 5
    const __m256i high = _mm256_unpackhi_epi32(place, middle);  // 2 3 6 7
    auto* out = reinterpret_cast<__m256i*>(points + k);
    _mm256_storeu_si256(out, _mm256_permute2x128_si256(low, high, 0x20));
    _mm256_storeu_si256(out + 1, _mm256_permute2x128_si256(low, high, 0x31));
  }
}

}  // namespace

const EdgeRowKernel& avx2EdgeRows();
const EdgeRowKernel& avx2EdgeRows() {
  static constexpr EdgeRowKernel kKernel{
      "avx2",         kWordBlock,         grayLoop,   strongestLoop, columnsLoop,   gradientLoop,
      maximaLoop,     listLoop,           pointsLoop, linkLoop,      listLinksLoop, bridgeSteepLoop,
      bridgeFlatLoop, bridgeDiagonalLoop, startsLoop, findRuns,      overlapsLoop};
  return kKernel;
}

}  // namespace vismem
