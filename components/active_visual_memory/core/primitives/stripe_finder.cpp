#include "active_visual_memory/core/primitives/stripe_finder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

/// The stripe of two edges, if they are its two edges.
std::optional<FloorEdge> between(const FloorEdge& a, const FloorEdge& b, const StripeParams& params) {
  // Opposite polarity: the brighter sides face inwards (a bright line) or outwards (a dark one).
  if (a.along.dot(b.along) > -std::cos(params.max_angle_rad)) return std::nullopt;
  const double side_of_b = cross2(a.along, b.line.middle() - a.line.a);
  const double side_of_a = cross2(b.along, a.line.middle() - b.line.a);
  if (side_of_a * side_of_b <= 0.0) return std::nullopt;
  if (!labelsCompatible(a.label, b.label)) return std::nullopt;
  const double rough = std::min(std::abs(side_of_a), std::abs(side_of_b));
  if (rough > 1.5 * params.max_width_m) return std::nullopt;

  const Eigen::Vector2d along = (a.length * a.along - b.length * b.along).normalized();
  const Eigen::Vector2d normal = turned90(along);
  const auto t = [&](const Eigen::Vector2d& p) { return along.dot(p - a.line.a); };
  const double a_low = std::min(t(a.line.a), t(a.line.b)), a_high = std::max(t(a.line.a), t(a.line.b));
  const double b_low = std::min(t(b.line.a), t(b.line.b)), b_high = std::max(t(b.line.a), t(b.line.b));
  const double low = std::max(a_low, b_low);
  const double high = std::min(a_high, b_high);
  if (high - low < params.min_overlap * std::min(a.length, b.length)) return std::nullopt;
  // Distance at the middle of the overlap.
  const double middle = 0.5 * (low + high);
  const auto offset = [&](const FloorEdge& edge) {
    const double slope = normal.dot(edge.along) / along.dot(edge.along);
    return normal.dot(edge.line.a - a.line.a) + slope * (middle - t(edge.line.a));
  };
  const double offset_a = offset(a);
  const double offset_b = offset(b);
  const double width = std::abs(offset_a - offset_b);
  if (width < params.min_width_m || width > params.max_width_m) return std::nullopt;
  const double from = std::min(a_low, b_low);
  const double to = std::max(a_high, b_high);
  if (to - from < params.min_slenderness * width) return std::nullopt;
  const Eigen::Vector2d base = a.line.a + 0.5 * (offset_a + offset_b) * normal;
  return makeFloorEdge({base + from * along, base + to * along}, a.label == kUnknownLabel ? b.label : a.label,
                       joinedIds(a.segments, b.segments), width);
}

/// Two pieces of one line as one, if they are such.
std::optional<FloorEdge> joined(const FloorEdge& a, const FloorEdge& b, const StripeParams& params) {
  const double same_way = a.along.dot(b.along) > 0.0 ? 1.0 : -1.0;
  if (std::abs(a.along.dot(b.along)) < std::cos(params.max_angle_rad)) return std::nullopt;
  if (std::abs(a.width_m - b.width_m) > 0.5 * std::max(a.width_m, b.width_m)) return std::nullopt;
  const Eigen::Vector2d along = (a.length * a.along + same_way * b.length * b.along).normalized();
  if (std::abs(cross2(along, b.line.middle() - a.line.middle())) > params.max_offset_m) return std::nullopt;
  const auto t = [&](const Eigen::Vector2d& p) { return along.dot(p - a.line.a); };
  const double a_low = std::min(t(a.line.a), t(a.line.b)), a_high = std::max(t(a.line.a), t(a.line.b));
  const double b_low = std::min(t(b.line.a), t(b.line.b)), b_high = std::max(t(b.line.a), t(b.line.b));
  if (std::max(a_low, b_low) - std::min(a_high, b_high) > params.max_gap_m) return std::nullopt;
  const double total = a.length + b.length;
  const Eigen::Vector2d middle = (a.length * a.line.middle() + b.length * b.line.middle()) / total;
  const Eigen::Vector2d base = middle - t(middle) * along;
  return makeFloorEdge({base + std::min(a_low, b_low) * along, base + std::max(a_high, b_high) * along},
                       a.label, joinedIds(a.segments, b.segments),
                       (a.length * a.width_m + b.length * b.width_m) / total);
}

}  // namespace

std::vector<FloorEdge> findStripes(const std::vector<FloorEdge>& edges, const StripeParams& params) {
  std::vector<FloorEdge> stripes;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (auto stripe = between(edges[i], edges[j], params)) stripes.push_back(std::move(*stripe));
    }
  }
  // Longest first, so that the pieces join what they belong to.
  const auto longer = [](const FloorEdge& a, const FloorEdge& b) { return a.length > b.length; };
  std::stable_sort(stripes.begin(), stripes.end(), longer);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < stripes.size() && !again; ++i) {
      for (std::size_t j = i + 1; j < stripes.size() && !again; ++j) {
        if (auto one = joined(stripes[i], stripes[j], params)) {
          stripes[i] = std::move(*one);
          stripes.erase(stripes.begin() + static_cast<std::ptrdiff_t>(j));
          again = true;
        }
      }
    }
  }
  std::stable_sort(stripes.begin(), stripes.end(), longer);
  return stripes;
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
  primitive.segments = stripe.segments;
  return primitive;
}

}  // namespace vismem
