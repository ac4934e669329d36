/// @file Seeds of independent random streams. Pure.
#pragma once

#include <cstdint>
#include <string_view>

namespace vismem {

/// Seed of one named random stream: adding or using a stream changes no other.
constexpr std::uint64_t subStream(std::uint64_t seed, std::string_view name) {
  // FNV-1a over the name, then the splitmix64 finaliser over both.
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::uint64_t z = hash + seed * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace vismem
