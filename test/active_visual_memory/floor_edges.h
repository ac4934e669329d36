/// @file Edges for tests of the finders, with memory for their results that lasts as long as the program.
#pragma once

#include <array>
#include <memory_resource>
#include <numeric>
#include <vector>

#include "active_visual_memory/core/primitives/floor_edge.h"

namespace vismem::testing {

inline std::pmr::memory_resource* scratch() {
  static std::pmr::monotonic_buffer_resource resource;
  return &resource;
}

/// @param id    below 200. @param label  that lasts.
inline FloorEdge edge(std::uint64_t id, const Segment2& line, std::string_view label = "line",
                      double width_m = 0.0) {
  static const std::array<std::uint64_t, 200> ids = [] {
    std::array<std::uint64_t, 200> all{};
    std::iota(all.begin(), all.end(), 0);
    return all;
  }();
  return *makeFloorEdge(line, label, {&ids.at(id), 1}, width_m);
}

template <typename Ids>
std::vector<std::uint64_t> listed(const Ids& ids) {
  return {ids.begin(), ids.end()};
}

}  // namespace vismem::testing
