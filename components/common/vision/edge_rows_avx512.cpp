// The same loops for x86-64 processors with AVX-512 (F, BW, VL, DQ; called only where it is present), which
// choose values by masks of bits: what the planes are.
#include <immintrin.h>

#include "common/vision/edge_rows.h"

namespace vismem {
namespace {

#include "common/vision/edge_links.inc"
#include "common/vision/edge_rows_loops.inc"
#include "common/vision/line_runs.inc"

/// Bits of `word` (64 columns from 64 * word on) that are in begin..end-1.
std::uint64_t inside(int word, int begin, int end) {
  const int low = begin - 64 * word;
  const int high = end - 64 * word;
  const std::uint64_t from = low <= 0 ? ~std::uint64_t{0} : low >= 64 ? 0 : ~std::uint64_t{0} << low;
  const std::uint64_t to = high <= 0 ? 0 : high >= 64 ? ~std::uint64_t{0} : ~(~std::uint64_t{0} << high);
  return from & to;
}

void maximaMasks(const std::int16_t* const magnitude[3], const std::int16_t* kind, int begin, int end,
                 std::int16_t minimum, std::uint8_t* /*mask*/, int words, const EdgeBits& bits) {
  const EdgeBits out = bits;
  const std::int16_t* above = magnitude[0];
  const std::int16_t* here = magnitude[1];
  const std::int16_t* below = magnitude[2];
  const __m512i least = _mm512_set1_epi16(minimum);
  for (int word = 0; word < words; ++word) {
    std::uint64_t planes[5] = {};
    const std::uint64_t valid = inside(word, begin, end);
    for (int half = 0; half < 2; ++half) {
      const int x = 64 * word + 32 * half;
      const auto valid_half = static_cast<__mmask32>(valid >> (32 * half));
      if (valid_half == 0) continue;
      const __m512i middle = _mm512_loadu_si512(here + x);
      const __m512i which = _mm512_loadu_si512(kind + x);
      const __mmask32 steep = _mm512_test_epi16_mask(which, _mm512_set1_epi16(kSteepBit));
      const __m512i before =
          _mm512_mask_blend_epi16(steep, _mm512_loadu_si512(above + x), _mm512_loadu_si512(here + x - 1));
      const __m512i after =
          _mm512_mask_blend_epi16(steep, _mm512_loadu_si512(below + x), _mm512_loadu_si512(here + x + 1));
      __mmask32 edge = _mm512_mask_cmpge_epi16_mask(valid_half, middle, least);
      edge = _mm512_mask_cmpgt_epi16_mask(edge, middle, before);
      edge = _mm512_mask_cmpge_epi16_mask(edge, middle, after);
      const auto put = [&](int plane, __mmask32 mask) {
        planes[plane] |= static_cast<std::uint64_t>(mask) << (32 * half);
      };
      put(0, edge);
      put(1, edge & steep);
      put(2, _mm512_mask_test_epi16_mask(edge, which, _mm512_set1_epi16(kRightBit)));
      put(3, _mm512_mask_test_epi16_mask(edge, which, _mm512_set1_epi16(kDownBit)));
      put(4, _mm512_mask_test_epi16_mask(edge, which, _mm512_set1_epi16(kDiagonalBit)));
    }
    out.edge[word] = planes[0];
    out.steep[word] = planes[1];
    out.right[word] = planes[2];
    out.down[word] = planes[3];
    out.diagonal[word] = planes[4];
  }
}

int listMasks(const std::uint64_t* edge, int words, std::int32_t first, std::uint16_t* columns,
              std::int32_t* index) {
  const __m512i steps = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int found = 0;
  for (int word = 0; word < words; ++word) {
    const std::uint64_t bits = edge[word];
    if (bits == 0) continue;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const auto mask = static_cast<__mmask16>(bits >> (16 * quarter));
      const int x = 64 * word + 16 * quarter;
      const __m512i here = _mm512_add_epi32(steps, _mm512_set1_epi32(x));
      const __m512i packed = _mm512_maskz_compress_epi32(mask, here);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(columns + found), _mm512_cvtepi32_epi16(packed));
      const __m512i numbers = _mm512_add_epi32(steps, _mm512_set1_epi32(first + found));
      _mm512_storeu_si512(index + x, _mm512_maskz_expand_epi32(mask, numbers));
      found += __builtin_popcount(mask);
    }
  }
  return found;
}

/// Gathers by packing what the planes mark, and then takes sixteen points at a time.
void pointsMasks(const std::int16_t* const gradient[3], const EdgeRowPoints& row, EdgePoint* points) {
  const auto* above = reinterpret_cast<const std::int32_t*>(gradient[0]);
  const auto* here = reinterpret_cast<const std::int32_t*>(gradient[1]);
  const auto* below = reinterpret_cast<const std::int32_t*>(gradient[2]);
  const std::ptrdiff_t room = 64 * row.words + kEdgePointBlock;
  std::int32_t* middles = row.work;
  std::int32_t* befores = middles + room;
  std::int32_t* afters = befores + room;
  int found = 0;
  for (int word = 0; word < row.words; ++word) {
    const std::uint64_t bits = row.bits.edge[word];
    if (bits == 0) continue;
    const std::uint64_t steep_bits = row.bits.steep[word];
    for (int quarter = 0; quarter < 4; ++quarter) {
      const auto mask = static_cast<__mmask16>(bits >> (16 * quarter));
      const auto steep = static_cast<__mmask16>(steep_bits >> (16 * quarter));
      const int x = 64 * word + 16 * quarter;
      const __m512i before =
          _mm512_mask_blend_epi32(steep, _mm512_loadu_si512(above + x), _mm512_loadu_si512(here + x - 1));
      const __m512i after =
          _mm512_mask_blend_epi32(steep, _mm512_loadu_si512(below + x), _mm512_loadu_si512(here + x + 1));
      _mm512_storeu_si512(middles + found, _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(here + x)));
      _mm512_storeu_si512(befores + found, _mm512_maskz_compress_epi32(mask, before));
      _mm512_storeu_si512(afters + found, _mm512_maskz_compress_epi32(mask, after));
      found += __builtin_popcount(mask);
    }
  }
  const __m512i y = _mm512_set1_epi32((row.y & 255) << 16);
  const __m512i steep_bit = _mm512_set1_epi32(1 << 24);
  // From columns of numbers to points.
  const __m512i first_eight = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i last_eight = _mm512_add_epi32(first_eight, _mm512_set1_epi32(8));
  const __m512 limit = _mm512_set1_ps(kMaximumOffset_px);
  for (int k = 0; k < row.count; k += 16) {
    const __m512i x =
        _mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(row.columns + k)));
    const __m512i middle = _mm512_loadu_si512(middles + k);
    const __m512i size = _mm512_abs_epi16(middle);
    const __mmask16 flat = _mm512_cmpgt_epi32_mask(_mm512_srli_epi32(size, 16),
                                                   _mm512_and_si512(size, _mm512_set1_epi32(0xffff)));
    const __m512i squared = _mm512_madd_epi16(middle, middle);
    const __m512i before = _mm512_madd_epi16(middle, _mm512_loadu_si512(befores + k));
    const __m512i after = _mm512_madd_epi16(middle, _mm512_loadu_si512(afters + k));
    const __m512i sum = _mm512_add_epi32(_mm512_sub_epi32(squared, before), _mm512_sub_epi32(squared, after));
    const __m512 curvature = _mm512_cvtepi32_ps(_mm512_max_epi32(sum, _mm512_set1_epi32(1)));
    const __m512 skew = _mm512_cvtepi32_ps(_mm512_sub_epi32(after, before));
    __m512 offset = _mm512_div_ps(_mm512_mul_ps(_mm512_set1_ps(0.5F), skew), curvature);
    offset = _mm512_max_ps(offset, _mm512_sub_ps(_mm512_setzero_ps(), limit));
    offset = _mm512_min_ps(offset, limit);
    const __m512i aside = _mm512_sub_epi32(
        _mm512_cvttps_epi32(_mm512_add_ps(_mm512_mul_ps(offset, _mm512_set1_ps(kOffsetUnits)),
                                          _mm512_set1_ps(static_cast<float>(kOffsetZero) + 0.5F))),
        _mm512_set1_epi32(kOffsetZero));
    __m512i place = _mm512_or_si512(_mm512_or_si512(x, y), _mm512_slli_epi32(aside, 25));
    place = _mm512_mask_or_epi32(place, static_cast<__mmask16>(~flat), place, steep_bit);
    auto* out = points + k;
    _mm512_storeu_si512(out, _mm512_permutex2var_epi32(place, first_eight, middle));
    _mm512_storeu_si512(out + 8, _mm512_permutex2var_epi32(place, last_eight, middle));
  }
}

int listLinksMasks(const EdgeBits& here, const EdgeLinks& links_made, int words, const EdgeColumns& given,
                   std::int32_t* from, std::int32_t* to) {
  const EdgeColumns columns = given;
  LinkList list{from, to};
  const auto put = [&](__mmask16 some, __mmask16 onward, __m512i point, __m512i other) {
    const __m512i begin = _mm512_mask_blend_epi32(onward, other, point);
    const __m512i end = _mm512_mask_blend_epi32(onward, point, other);
    _mm512_storeu_si512(from + list.found, _mm512_maskz_compress_epi32(some, begin));
    _mm512_storeu_si512(to + list.found, _mm512_maskz_compress_epi32(some, end));
    list.found += __builtin_popcount(some);
  };
  for (int word = 0; word < words; ++word) {
    const WordLinks links(here, links_made, word);
    if ((links.left | links.all) == 0) continue;
    for (int quarter = 0; quarter < 64; quarter += 16) {
      const auto part = [&](std::uint64_t bits) { return static_cast<__mmask16>(bits >> quarter); };
      const int x = 64 * word + quarter;
      const __m512i point = _mm512_loadu_si512(columns.here + x);
      put(part(links.left), part(links.left_onward), point,
          _mm512_loadu_si512(columns.here + x - columns.aside));
      const std::int32_t* above = columns.above + x;
      __m512i other = _mm512_loadu_si512(above);
      other = _mm512_mask_mov_epi32(other, part(links.above_left), _mm512_loadu_si512(above - columns.aside));
      other = _mm512_mask_mov_epi32(other, part(links.only_right), _mm512_loadu_si512(above + columns.aside));
      put(part(links.all), part(links.onward), point, other);
    }
    list.putSecond(links, columns, 64 * word);
  }
  return list.found;
}

int overlapsMasks(const BoxLanes& boxes, const BoxQuery& query, int begin, int end, std::int32_t* lanes) {
  const __m512i left = _mm512_set1_epi16(query.left);
  const __m512i right = _mm512_set1_epi16(query.right);
  const __m512i top = _mm512_set1_epi16(query.top);
  const __m512i bottom = _mm512_set1_epi16(query.bottom);
  const __m512i lowest = _mm512_set1_epi16(static_cast<std::int16_t>(query.lowest_angle));
  const __m512i span = _mm512_set1_epi16(static_cast<std::int16_t>(query.angle_span));
  int found = 0;
  for (int lane = begin; lane < end; lane += kBoxBlock) {
    const int rest = end - lane;
    __mmask32 mask = rest >= kBoxBlock ? ~__mmask32{0} : (__mmask32{1} << rest) - 1;
    mask = _mm512_mask_cmple_epi16_mask(mask, _mm512_loadu_si512(boxes.left + lane), right);
    mask = _mm512_mask_cmpge_epi16_mask(mask, _mm512_loadu_si512(boxes.right + lane), left);
    mask = _mm512_mask_cmple_epi16_mask(mask, _mm512_loadu_si512(boxes.top + lane), bottom);
    mask = _mm512_mask_cmpge_epi16_mask(mask, _mm512_loadu_si512(boxes.bottom + lane), top);
    mask = _mm512_mask_cmple_epu16_mask(
        mask, _mm512_sub_epi16(_mm512_loadu_si512(boxes.angle + lane), lowest), span);
    for (std::uint32_t bits = mask; bits != 0; bits &= bits - 1) lanes[found++] = lane + __builtin_ctz(bits);
  }
  return found;
}

EdgeChainEnds startsMasks(const std::int16_t* next, const std::uint8_t* previous, int count,
                          std::int32_t* starts, std::int32_t* tops) {
  const __m512i steps = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  EdgeChainEnds found;
  for (int i = 0; i < count; i += 32) {
    const auto valid = static_cast<__mmask32>(~std::uint64_t{0} >> (count - i < 32 ? 64 - (count - i) : 32));
    const __m512i onwards = _mm512_loadu_si512(next + i);
    const __m256i before = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(previous + i));
    const __mmask32 starting = _mm256_mask_cmpeq_epi8_mask(
        _mm512_mask_test_epi16_mask(valid, onwards, onwards), before, _mm256_set1_epi8(kNone));
    const __mmask32 topmost =
        _mm256_mask_cmpeq_epi8_mask(_mm512_mask_cmpgt_epi16_mask(valid, onwards, _mm512_setzero_si512()),
                                    before, _mm256_set1_epi8(kLater));
    for (int half = 0; half < 32; half += 16) {
      const __m512i index = _mm512_add_epi32(steps, _mm512_set1_epi32(i + half));
      const auto some = static_cast<__mmask16>(starting >> half);
      _mm512_storeu_si512(starts + found.starts, _mm512_maskz_compress_epi32(some, index));
      found.starts += __builtin_popcount(some);
      const auto others = static_cast<__mmask16>(topmost >> half);
      _mm512_storeu_si512(tops + found.tops, _mm512_maskz_compress_epi32(others, index));
      found.tops += __builtin_popcount(others);
    }
  }
  return found;
}

}  // namespace

const EdgeRowKernel& avx512EdgeRows();
const EdgeRowKernel& avx512EdgeRows() {
  static constexpr EdgeRowKernel kKernel{
      "avx512",       kWordBlock,         grayLoop,    strongestLoop, columnsLoop,    gradientLoop,
      maximaMasks,    listMasks,          pointsMasks, linkLoop,      listLinksMasks, bridgeSteepLoop,
      bridgeFlatLoop, bridgeDiagonalLoop, startsMasks, findRuns,      overlapsMasks};
  return kKernel;
}

}  // namespace vismem
