#include "common/robot_ice/md5.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace vismem {
namespace {

using State = std::array<std::uint32_t, 4>;
constexpr std::size_t kBlock = 64;

/// RFC 1321, 3.4: T[i] = floor(2^32 |sin(i + 1)|), i + 1 in radians.
std::array<std::uint32_t, 64> sineTable() {
  std::array<std::uint32_t, 64> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<std::uint32_t>(std::abs(std::sin(static_cast<double>(i + 1))) * 4294967296.0);
  }
  return table;
}

std::uint32_t wordAt(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap32(word);
  return word;
}

/// The sixteen steps of a round; the four state words rotate from step to step, without cost when the loop is
/// unrolled. `First` is the round's first step of 0..63.
template <int First, int Multiplier, int Offset, int S0, int S1, int S2, int S3, typename Mix>
void addRound(State& state, const std::array<std::uint32_t, 16>& words,
              const std::array<std::uint32_t, 64>& sines, Mix mix) {
  auto [a, b, c, d] = state;
  const auto step = [&](std::uint32_t& w, std::uint32_t x, std::uint32_t y, std::uint32_t z, int i,
                        int shift) {
    w = x + std::rotl(w + mix(x, y, z) + sines[First + i] + words[(Multiplier * i + Offset) % 16], shift);
  };
#pragma GCC unroll 4
  for (int i = 0; i < 16; i += 4) {
    step(a, b, c, d, i, S0);
    step(d, a, b, c, i + 1, S1);
    step(c, d, a, b, i + 2, S2);
    step(b, c, d, a, i + 3, S3);
  }
  state = {a, b, c, d};
}

void addBlock(State& state, const std::uint8_t* block, const std::array<std::uint32_t, 64>& sines) {
  std::array<std::uint32_t, 16> words{};
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = wordAt(block + 4 * i);
  State next = state;
  using U = std::uint32_t;
  // Each mix is RFC 1321's, in the form with the shortest chain of operations.
  addRound<0, 1, 0, 7, 12, 17, 22>(next, words, sines, [](U x, U y, U z) { return z ^ (x & (y ^ z)); });
  addRound<16, 5, 1, 5, 9, 14, 20>(next, words, sines, [](U x, U y, U z) { return (z & x) + (~z & y); });
  addRound<32, 3, 5, 4, 11, 16, 23>(next, words, sines, [](U x, U y, U z) { return x ^ (y ^ z); });
  addRound<48, 7, 0, 6, 10, 15, 21>(next, words, sines, [](U x, U y, U z) { return y ^ (x | ~z); });
  for (std::size_t i = 0; i < state.size(); ++i) state[i] += next[i];
}

}  // namespace

std::string md5Hex(std::span<const std::uint8_t> bytes) {
  static const std::array<std::uint32_t, 64> sines = sineTable();
  State state = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  std::size_t at = 0;
  for (; at + kBlock <= bytes.size(); at += kBlock) addBlock(state, bytes.data() + at, sines);
  // The rest, a one bit, zeros, and the length in bits end the last one or two blocks.
  std::array<std::uint8_t, 2 * kBlock> tail{};
  const std::size_t rest = bytes.size() - at;
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), tail.begin());
  tail[rest] = 0x80;
  const std::size_t end = rest + 9 <= kBlock ? kBlock : 2 * kBlock;
  const std::uint64_t bits = static_cast<std::uint64_t>(bytes.size()) * 8;
  for (std::size_t i = 0; i < 8; ++i) tail[end - 8 + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  for (at = 0; at < end; at += kBlock) addBlock(state, tail.data() + at, sines);

  static constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const std::uint32_t word : state) {
    for (int byte = 0; byte < 4; ++byte) {
      const std::uint32_t value = (word >> (8 * byte)) & 0xff;
      hex += kDigits[value >> 4];
      hex += kDigits[value & 15];
    }
  }
  return hex;
}

}  // namespace vismem
