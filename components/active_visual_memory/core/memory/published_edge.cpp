#include "active_visual_memory/core/memory/published_edge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "common/geometry/plane.h"

namespace vismem {

PublishedEdge::PublishedEdge(MemorySegment& published_segment, const MemoryElement* of)
    : published(&published_segment),
      element(of),
      line(published_segment.odom.floor()),
      along((line.b - line.a).normalized()) {}

std::pmr::vector<PublishedEdge> publishedEdges(std::vector<MemorySegment>& segments,
                                               std::span<const MemoryElement> elements,
                                               std::pmr::memory_resource* scratch) {
  std::pmr::vector<PublishedEdge> edges(scratch);
  edges.reserve(segments.size());
  auto next = elements.begin();  // most segments come in the order of the elements
  for (MemorySegment& segment : segments) {
    const bool is_next = next != elements.end() && next->value.id == segment.id;
    const MemoryElement* const element = is_next ? &*next : findElement(elements, segment.id);
    if (element) next = elements.begin() + (element - elements.data() + 1);
    edges.emplace_back(segment, element);
  }
  return edges;
}

void placeAt(MemorySegment& published, const Segment2& line) {
  published.odom.a.head<2>() = line.a;
  published.odom.b.head<2>() = line.b;
}

void eraseSegments(std::vector<MemorySegment>& segments, std::span<const std::uint64_t> ids) {
  std::erase_if(segments,
                [&](const MemorySegment& s) { return std::find(ids.begin(), ids.end(), s.id) != ids.end(); });
}

std::optional<EdgeCorner> findCorner(const PublishedEdge& one, const PublishedEdge& other,
                                     const CornerParams& params) {
  const Eigen::Vector2d between = other.line.a - one.line.b;
  if (between.norm() > 2.0 * params.reach.most_m) return std::nullopt;
  const ExtentEnd& end = one.element->line.endB();
  const ExtentEnd& begin = other.element->line.endA();
  const double cross = cross2(one.along, other.along);
  if (end.censored || begin.censored || std::abs(cross) < std::sin(params.min_angle_rad)) return std::nullopt;
  const double outward_one = cross2(between, other.along) / cross;
  const double outward_other = cross2(between, one.along) / cross;
  if (std::abs(outward_one) > params.reach.of(end) || std::abs(outward_other) > params.reach.of(begin)) {
    return std::nullopt;
  }
  return EdgeCorner{one.line.b + outward_one * one.along, std::abs(outward_one) + std::abs(outward_other)};
}

void joinAtCorners(std::span<const PublishedEdge> edges, const CornerParams& params,
                   std::pmr::memory_resource* scratch) {
  struct Joint {
    std::size_t from;
    std::size_t to;
    EdgeCorner corner;
  };
  std::pmr::vector<Joint> joints(scratch);
  std::pmr::vector<std::size_t> with_ends(scratch);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].element && edges[i].confirmed()) with_ends.push_back(i);
  }
  for (const std::size_t i : with_ends) {
    for (const std::size_t k : with_ends) {
      if (i == k) continue;
      if (const auto corner = findCorner(edges[i], edges[k], params)) joints.push_back({i, k, *corner});
    }
  }
  // The nearest first; an end has one corner.
  std::sort(joints.begin(), joints.end(), [](const Joint& a, const Joint& b) {
    return std::tie(a.corner.distance_m, a.from, a.to) < std::tie(b.corner.distance_m, b.from, b.to);
  });
  std::pmr::vector<bool> ended(edges.size(), false, scratch);
  std::pmr::vector<bool> begun(edges.size(), false, scratch);
  for (const Joint& joint : joints) {
    if (ended[joint.from] || begun[joint.to]) continue;
    ended[joint.from] = begun[joint.to] = true;
    edges[joint.from].published->odom.b.head<2>() = joint.corner.place;
    edges[joint.to].published->odom.a.head<2>() = joint.corner.place;
  }
}

}  // namespace vismem
