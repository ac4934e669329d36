/// @file Hashes, and seeds of independent random streams. Pure.
#pragma once

#include <cstdint>
#include <string_view>

namespace vismem {

/// FNV-1a over bytes.
/// @param hash of the bytes before.
constexpr std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325ULL) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  return hash;
}

/// Seed of one named random stream: adding or using a stream changes no other.
constexpr std::uint64_t subStream(std::uint64_t seed, std::string_view name) {
  // The splitmix64 finaliser over the name's hash and the seed.
  std::uint64_t z = fnv1a(name) + seed * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace vismem
