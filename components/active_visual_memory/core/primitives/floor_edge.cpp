#include "active_visual_memory/core/primitives/floor_edge.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/plane.h"

namespace vismem {

std::optional<FloorEdge> makeFloorEdge(const Segment2& line, std::string_view label, SegmentIds segments,
                                       double width_m) {
  const double length = line.length();
  if (!(length > 0.0)) return std::nullopt;
  return FloorEdge{line, (line.b - line.a) / length, length, label, width_m, segments};
}

FloorEdges floorEdges(std::span<const MemorySegment> segments, bool confirmed_only,
                      std::pmr::memory_resource* scratch) {
  FloorEdges edges(scratch);
  edges.reserve(segments.size());
  for (const MemorySegment& segment : segments) {
    if (confirmed_only && !segment.confirmed) continue;
    if (auto edge = makeFloorEdge(segment.odom.floor(), segment.label, {&segment.id, 1})) {
      edges.push_back(*edge);
    }
  }
  return edges;
}

SegmentIds joinedIds(SegmentIds a, SegmentIds b, std::pmr::memory_resource* scratch) {
  std::uint64_t* const ids =
      std::pmr::polymorphic_allocator<>(scratch).allocate_object<std::uint64_t>(a.size() + b.size());
  return {ids, std::set_union(a.begin(), a.end(), b.begin(), b.end(), ids)};
}

bool shareIds(SegmentIds a, SegmentIds b) {
  auto x = a.begin();
  auto y = b.begin();
  while (x != a.end() && y != b.end()) {
    if (*x == *y) return true;
    *x < *y ? ++x : ++y;
  }
  return false;
}

std::optional<Eigen::Vector2d> intersection(const FloorEdge& a, const FloorEdge& b) {
  const double turn = cross2(a.along, b.along);
  if (std::abs(turn) < 0.01) return std::nullopt;
  return a.line.a + a.along * (cross2(b.line.a - a.line.a, b.along) / turn);
}

}  // namespace vismem
