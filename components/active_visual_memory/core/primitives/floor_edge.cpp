#include "active_visual_memory/core/primitives/floor_edge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/geometry/plane.h"

namespace vismem {

std::optional<FloorEdge> makeFloorEdge(const Segment2& line, Label label, std::vector<std::uint64_t> segments,
                                       double width_m) {
  FloorEdge edge;
  edge.line = line;
  edge.length = line.length();
  if (!(edge.length > 0.0)) return std::nullopt;
  edge.along = (line.b - line.a) / edge.length;
  edge.label = std::move(label);
  edge.segments = std::move(segments);
  edge.width_m = width_m;
  return edge;
}

std::vector<FloorEdge> floorEdges(std::span<const MemorySegment> segments, bool confirmed_only) {
  std::vector<FloorEdge> edges;
  edges.reserve(segments.size());
  for (const MemorySegment& segment : segments) {
    if (confirmed_only && !segment.confirmed) continue;
    if (auto edge = makeFloorEdge(segment.odom.floor(), segment.label, {segment.id})) {
      edges.push_back(std::move(*edge));
    }
  }
  return edges;
}

std::vector<std::uint64_t> joinedIds(const std::vector<std::uint64_t>& a,
                                     const std::vector<std::uint64_t>& b) {
  std::vector<std::uint64_t> both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

bool shareIds(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
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
