#include "active_visual_memory/core/primitives/primitive_finder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// Chooses the best readings: a shape that mostly uses segments of a better one is dropped. Neighbours may
/// share one side.
void choose(std::vector<Primitive> readings, int may_share, const PrimitiveParams& params,
            std::vector<Primitive>& chosen) {
  std::stable_sort(readings.begin(), readings.end(),
                   [](const Primitive& a, const Primitive& b) { return a.quality > b.quality; });
  for (Primitive& reading : readings) {
    const bool known = std::any_of(chosen.begin(), chosen.end(), [&](const Primitive& better) {
      return sharedIds(reading, better) > may_share || sameShape(reading, better, params);
    });
    if (!known) chosen.push_back(std::move(reading));
  }
}

/// The edges that share no segment with some others. @param others  shapes or edges.
template <typename Other>
std::vector<FloorEdge> without(std::vector<FloorEdge> edges, const std::vector<Other>& others) {
  std::erase_if(edges, [&](const FloorEdge& edge) {
    return std::any_of(others.begin(), others.end(),
                       [&](const Other& other) { return shareIds(edge.segments, other.segments); });
  });
  return edges;
}

double sizeOf(const Primitive& primitive) {
  if (primitive.kind == PrimitiveKind::kCircle) return primitive.radius_m;
  double size = 0.0;
  for (const auto& v : primitive.vertices) size = std::max(size, (v - primitive.centre).norm());
  return size;
}

/// Confirmed share of the length of the segments of a shape.
double confirmedShare(const Primitive& shape, std::span<const MemorySegment> segments) {
  double confirmed = 0.0;
  double all = 0.0;
  for (const MemorySegment& segment : segments) {
    if (!std::binary_search(shape.segments.begin(), shape.segments.end(), segment.id)) continue;
    const double length = segment.odom.floor().length();
    all += length;
    if (segment.confirmed) confirmed += length;
  }
  return all > 0.0 ? confirmed / all : 0.0;
}

std::vector<Primitive> findAmong(const std::vector<FloorEdge>& edges, const PrimitiveParams& params) {
  std::vector<Primitive> found;
  choose(findCircles(edges, params.circles), 0, params, found);
  const std::vector<FloorEdge> straight = without(edges, found);
  const std::vector<FloorEdge> stripes = findStripes(straight, params.stripes);
  const std::vector<FloorEdge> single = without(straight, stripes);
  std::vector<FloorEdge> strokes = stripes;
  strokes.insert(strokes.end(), single.begin(), single.end());
  std::vector<Primitive> arrows;
  choose(findArrows(strokes, params.arrows, params.polygons.max_side_m), 0, params, arrows);
  const std::vector<FloorEdge> lines = without(stripes, arrows);
  std::vector<FloorEdge> sides = without(single, arrows);
  sides.insert(sides.end(), lines.begin(), lines.end());
  std::vector<Primitive> polygons;
  choose(findPolygons(sides, params.polygons), 1, params, polygons);
  found.insert(found.end(), arrows.begin(), arrows.end());
  found.insert(found.end(), polygons.begin(), polygons.end());
  for (const FloorEdge& stripe : lines) found.push_back(stripePrimitive(stripe));
  return found;
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

std::vector<Primitive> findPrimitives(std::span<const MemorySegment> segments,
                                      const PrimitiveParams& params) {
  std::vector<Primitive> found = findAmong(floorEdges(segments, params.confirmed_only), params);
  if (!params.confirmed_only) return found;

  // An unconfirmed labelled segment may close a shape of confirmed ones: an edge off the floor would not
  // fit.
  const auto is_stripe = [](const Primitive& shape) { return shape.kind == PrimitiveKind::kStripe; };
  std::vector<Primitive> closed;
  std::remove_copy_if(found.begin(), found.end(), std::back_inserter(closed), is_stripe);
  std::vector<MemorySegment> labelled(segments.begin(), segments.end());
  std::erase_if(labelled, [](const MemorySegment& s) { return !s.confirmed && s.label == kUnknownLabel; });
  std::vector<Primitive> more = findAmong(without(floorEdges(labelled, false), closed), params);
  std::erase_if(more, [&](const Primitive& shape) {
    const bool known = std::any_of(closed.begin(), closed.end(), [&](const Primitive& better) {
      return better.kind == shape.kind && (better.centre - shape.centre).norm() <= params.same_place_m;
    });
    return is_stripe(shape) || known || confirmedShare(shape, segments) < params.confirmed_share;
  });
  std::erase_if(found, [&](const Primitive& shape) {
    return is_stripe(shape) && std::any_of(more.begin(), more.end(), [&](const Primitive& better) {
             return shareIds(shape.segments, better.segments);
           });
  });
  found.insert(found.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return found;
}

}  // namespace vismem
