#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <ranges>

#include "active_visual_memory/core/memory/duplicates.h"
#include "active_visual_memory/core/primitives/finders.h"
#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

/// The stripe of two edges, if they are its two edges.
std::optional<FloorEdge> between(const FloorEdge& a, const FloorEdge& b, const StripeParams& params,
                                 std::pmr::memory_resource* scratch) {
  if (!labelsCompatible(a.label, b.label)) return std::nullopt;
  const auto beside = antiparallel(a.line, b.line, params.max_angle_rad);
  if (!beside || beside->overlap_m() < params.min_overlap * std::min(a.length, b.length)) return std::nullopt;
  const double width = beside->distance_m;
  if (width < params.min_width_m || width > params.max_width_m) return std::nullopt;
  const Eigen::Vector2d along = (a.length * a.along - b.length * b.along).normalized();
  const Eigen::Vector2d base =
      a.line.a + beside->middle_m() * a.along + 0.5 * beside->left_m * turned90(a.along);
  const auto t = [&](const Eigen::Vector2d& p) { return along.dot(p - base); };
  const double from = std::min(t(a.line.a), t(b.line.b));
  const double to = std::max(t(a.line.b), t(b.line.a));
  if (to - from < params.min_slenderness * width) return std::nullopt;
  return makeFloorEdge({base + from * along, base + to * along}, a.label == kUnknownLabel ? b.label : a.label,
                       joinedIds(a.segments, b.segments, scratch), width);
}

/// Two pieces of one line as one, if they are such. @param a  the longer one.
std::optional<FloorEdge> joined(const FloorEdge& a, const FloorEdge& b, const StripeParams& params,
                                std::pmr::memory_resource* scratch) {
  const Neighbourhood near = neighbourhood(a.line, b.line);
  if (near.distance_m > params.max_offset_m || near.gap_m > params.max_gap_m ||
      lineAngle(a.line, b.line) > params.max_angle_rad ||
      std::abs(a.width_m - b.width_m) > 0.5 * std::max(a.width_m, b.width_m)) {
    return std::nullopt;
  }
  const double same_way = a.along.dot(b.along) > 0.0 ? 1.0 : -1.0;
  const double total = a.length + b.length;
  const Eigen::Vector2d along = (a.length * a.along + same_way * b.length * b.along).normalized();
  const Eigen::Vector2d middle = (a.length * a.line.middle() + b.length * b.line.middle()) / total;
  const auto [from, to] = std::minmax({along.dot(a.line.a - middle), along.dot(a.line.b - middle),
                                       along.dot(b.line.a - middle), along.dot(b.line.b - middle)});
  return makeFloorEdge({middle + from * along, middle + to * along}, a.label,
                       joinedIds(a.segments, b.segments, scratch),
                       (a.length * a.width_m + b.length * b.width_m) / total);
}

/// Inserts an edge behind those that are as long.
void insertByLength(FloorEdges& edges, const FloorEdge& edge) {
  edges.insert(std::ranges::upper_bound(edges, edge.length, std::greater<>(), &FloorEdge::length), edge);
}

}  // namespace

FloorEdges findStripes(std::span<const FloorEdge> edges, const StripeParams& params,
                       std::pmr::memory_resource* scratch) {
  // Longest first, so that the pieces join what they belong to.
  FloorEdges stripes(scratch);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (const auto stripe = between(edges[i], edges[j], params, scratch)) insertByLength(stripes, *stripe);
    }
  }
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < stripes.size() && !again; ++i) {
      for (std::size_t j = i + 1; j < stripes.size() && !again; ++j) {
        if (const auto one = joined(stripes[i], stripes[j], params, scratch)) {
          stripes[i] = *one;
          stripes.erase(stripes.begin() + static_cast<std::ptrdiff_t>(j));
          again = true;
        }
      }
    }
  }
  FloorEdges sorted(scratch);
  for (const FloorEdge& stripe : stripes) insertByLength(sorted, stripe);
  return sorted;
}

Primitive stripePrimitive(const FloorEdge& stripe) {
  Primitive primitive;
  primitive.kind = PrimitiveKind::kStripe;
  primitive.vertices = {stripe.line.a, stripe.line.b};
  primitive.centre = stripe.line.middle();
  primitive.heading_rad = std::atan2(stripe.along.y(), stripe.along.x());
  if (primitive.heading_rad < 0.0) primitive.heading_rad += std::numbers::pi;
  primitive.length_m = stripe.length;
  primitive.width_m = stripe.width_m;
  primitive.quality = 1.0;
  primitive.segments.assign(stripe.segments.begin(), stripe.segments.end());
  return primitive;
}

}  // namespace vismem
