#include "active_visual_memory/core/primitives/primitive_finder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ranges>
#include <utility>

#include "active_visual_memory/core/primitives/floor_edge.h"

namespace vismem {
namespace {

int sharedIds(const Primitive& a, const Primitive& b) {
  int shared = 0;
  for (const std::uint64_t id : a.segments) {
    shared += std::binary_search(b.segments.begin(), b.segments.end(), id) ? 1 : 0;
  }
  return shared;
}

/// Adds the best readings: a shape that mostly uses segments of a better one is dropped. Neighbours may
/// share one side.
void choose(const Shapes& readings, int may_share, const PrimitiveParams& params, Shapes& chosen) {
  std::pmr::vector<const Primitive*> order(chosen.get_allocator());
  for (const Primitive& reading : readings) order.push_back(&reading);
  std::ranges::sort(order, {},
                    [](const Primitive* reading) { return std::pair(-reading->quality, reading); });
  for (const Primitive* reading : order) {
    const bool known = std::ranges::any_of(chosen, [&](const Primitive& better) {
      return sharedIds(*reading, better) > may_share || sameShape(*reading, better, params);
    });
    if (!known) chosen.push_back(*reading);
  }
}

/// The edges that share no segment with some others. @param others  shapes or edges.
template <typename Others>
FloorEdges without(const FloorEdges& edges, const Others& others) {
  FloorEdges rest(edges.get_allocator());
  std::ranges::copy_if(edges, std::back_inserter(rest), [&](const FloorEdge& edge) {
    return std::ranges::none_of(others,
                                [&](const auto& other) { return shareIds(edge.segments, other.segments); });
  });
  return rest;
}

double sizeOf(const Primitive& primitive) {
  if (primitive.kind == PrimitiveKind::kCircle) return primitive.radius_m;
  double size = 0.0;
  for (const auto& v : primitive.vertices) size = std::max(size, (v - primitive.centre).norm());
  return size;
}

}  // namespace

bool sameShape(const Primitive& a, const Primitive& b, const PrimitiveParams& params) {
  if (a.kind != b.kind || (a.centre - b.centre).norm() > params.same_place_m) return false;
  const double size_a = sizeOf(a);
  const double size_b = sizeOf(b);
  if (std::abs(size_a - size_b) > params.same_size_share * std::max(size_a, size_b)) return false;
  if (a.kind != PrimitiveKind::kStripe) return true;
  return std::abs(std::sin(a.heading_rad - b.heading_rad)) < 0.3;  // crossing lines may have one middle
}

Shapes findPrimitives(std::span<const MemorySegment> segments, const PrimitiveParams& params,
                      std::pmr::memory_resource* scratch) {
  const FloorEdges edges = floorEdges(segments, params.confirmed_only, scratch);
  Shapes found(scratch);
  choose(findCircles(edges, params.circles, scratch), 0, params, found);
  const FloorEdges straight = without(edges, found);
  const FloorEdges stripes = findStripes(straight, params.stripes, scratch);
  const FloorEdges single = without(straight, stripes);
  FloorEdges strokes(stripes, scratch);
  strokes.insert(strokes.end(), single.begin(), single.end());
  choose(findArrows(strokes, params.arrows, params.polygons.max_side_m, scratch), 0, params, found);
  const FloorEdges lines = without(stripes, found);
  FloorEdges sides = without(single, found);
  sides.insert(sides.end(), lines.begin(), lines.end());
  choose(findPolygons(sides, params.polygons, scratch), 1, params, found);
  for (const FloorEdge& stripe : lines) found.push_back(stripePrimitive(stripe));
  return found;
}

}  // namespace vismem
