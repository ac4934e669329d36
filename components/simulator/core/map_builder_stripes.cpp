#include "simulator/core/map_builder_stripes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/plane.h"
#include "common/geometry/rounding.h"

namespace vismem {
namespace {

constexpr double kMinWidth_m = 0.03;
constexpr double kMaxWidth_m = 0.12;
constexpr double kParallel = 0.9986;  // cosine of 3 degrees
constexpr double kMinOverlap_m = 0.02;
/// Maximum gap between the parts of a crossed stripe, beyond the width of the crossing one [m].
constexpr double kJunction_m = 0.01;
constexpr double kOnLine_m = 0.004;

struct Interval {
  double from = 0.0;
  double to = 0.0;
};

/// An edge on the floor and its unpaired intervals, along it [m].
struct Edge {
  Segment2 line;
  Eigen::Vector2d direction;
  std::vector<Interval> free;

  explicit Edge(const Segment2& s) : line(s), direction((s.b - s.a).normalized()), free{{0.0, s.length()}} {}
  double along(const Eigen::Vector2d& p) const { return (p - line.a).dot(direction); }
  Eigen::Vector2d at(double s) const { return line.a + s * direction; }
  void take(Interval taken) {
    std::vector<Interval> left;
    for (const auto& f : free) {
      if (taken.from - f.from > 1e-9) left.push_back({f.from, std::min(f.to, taken.from)});
      if (f.to - taken.to > 1e-9) left.push_back({std::max(f.from, taken.to), f.to});
    }
    free = std::move(left);
  }
};

struct Stripe {
  Segment2 middle;
  double width = 0.0;
};

/// The common interval of both edges becomes a stripe.
void pair(Edge& a, Edge& b, double width, std::vector<Stripe>& stripes) {
  for (const Interval fa : std::vector(a.free)) {
    for (const Interval fb : std::vector(b.free)) {
      const double b0 = a.along(b.at(fb.from));
      const double b1 = a.along(b.at(fb.to));
      const Interval both{std::max(fa.from, std::min(b0, b1)), std::min(fa.to, std::max(b0, b1))};
      if (both.to - both.from < kMinOverlap_m) continue;
      const double s0 = b.along(a.at(both.from));
      const double s1 = b.along(a.at(both.to));
      stripes.push_back({{0.5 * (a.at(both.from) + b.at(s0)), 0.5 * (a.at(both.to) + b.at(s1))}, width});
      a.take(both);
      b.take({std::min(s0, s1), std::max(s0, s1)});
    }
  }
}

/// Joins `b` to `a` if they are parts of one stripe on both sides of a crossing one.
bool join(Stripe& a, const Stripe& b) {
  if (std::abs(a.width - b.width) > kOnLine_m) return false;
  if (distanceToLine(b.middle.a, a.middle) > kOnLine_m || distanceToLine(b.middle.b, a.middle) > kOnLine_m) {
    return false;
  }
  const Edge line(a.middle);
  const double t0 = line.along(b.middle.a);
  const double t1 = line.along(b.middle.b);
  const double length = a.middle.length();
  const double gap = a.width + kJunction_m;
  if (std::min(t0, t1) > length + gap || std::max(t0, t1) < -gap) return false;
  a.middle = {line.at(std::min({0.0, t0, t1})), line.at(std::max({length, t0, t1}))};
  return true;
}

/// Extends the ends of a stripe to the middle lines of the stripes at its junctions.
void extendTo(Stripe& stripe, const Stripe& other) {
  const Eigen::Vector2d d = (stripe.middle.b - stripe.middle.a).normalized();
  const Eigen::Vector2d e = (other.middle.b - other.middle.a).normalized();
  const double cross = cross2(d, e);
  if (std::abs(cross) < 0.3) return;
  const Eigen::Vector2d r = other.middle.a - stripe.middle.a;
  const Eigen::Vector2d crossing = stripe.middle.a + cross2(r, e) / cross * d;
  const double reach = 0.5 * other.width / std::abs(cross) + kJunction_m;
  if (distanceToSegment(crossing, other.middle) > other.width) return;
  for (Eigen::Vector2d* end : {&stripe.middle.a, &stripe.middle.b}) {
    const Eigen::Vector2d outwards = *end == stripe.middle.a ? Eigen::Vector2d(-d) : d;
    const double ahead = (crossing - *end).dot(outwards);
    if (ahead > 0.0 && ahead < reach) *end = crossing;
  }
}

Eigen::Vector3d onFloor(const Eigen::Vector2d& p) {
  return {rounded(p.x(), 1e3), rounded(p.y(), 1e3), 0.0};  // in millimetres, as the rest of the map
}

void joinStripesOf(const std::vector<Segment2>& lines, const Label& name, const Label& edge_label,
                   SegmentMap& out) {
  std::vector<Edge> edges(lines.begin(), lines.end());
  struct Pair {
    double width;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (std::abs(edges[i].direction.dot(edges[j].direction)) < kParallel) continue;
      const double width = distanceToLine(edges[j].line.middle(), edges[i].line);
      if (width >= kMinWidth_m && width <= kMaxWidth_m) pairs.push_back({width, i, j});
    }
  }
  // To the millimetre, so that rounding errors do not change the order.
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    return std::lround(x.width * 1e3) < std::lround(y.width * 1e3);
  });
  std::vector<Stripe> found;
  for (const Pair& p : pairs) pair(edges[p.a], edges[p.b], p.width, found);

  std::vector<Stripe> stripes;
  for (Stripe stripe : found) {
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < stripes.size() && !again; ++i) {
        if (!join(stripes[i], stripe)) continue;
        stripe = stripes[i];
        stripes.erase(stripes.begin() + static_cast<std::ptrdiff_t>(i));
        again = true;
      }
    }
    stripes.push_back(stripe);
  }
  const std::vector<Stripe> apart = stripes;
  for (auto& stripe : stripes) {
    for (const auto& other : apart) extendTo(stripe, other);
  }
  double widest = 0.0;
  for (const auto& stripe : stripes) {
    const double width = std::round(stripe.width * 1e3) / 1e3;
    widest = std::max(widest, width);
    out.segments.push_back({{onFloor(stripe.middle.a), onFloor(stripe.middle.b)}, name, width});
  }
  for (const auto& edge : edges) {
    for (const auto& rest : edge.free) {
      if (rest.to - rest.from <= widest + kJunction_m) continue;
      out.segments.push_back({{onFloor(edge.at(rest.from)), onFloor(edge.at(rest.to))}, edge_label});
    }
  }
}

}  // namespace

SegmentMap joinStripes(const SegmentMap& edges, const std::map<Label, Label>& stripe_edges) {
  SegmentMap result;
  std::map<Label, std::vector<Segment2>> of_stripes;
  for (const auto& segment : edges.segments) {
    const bool edge_of_stripe =
        std::any_of(stripe_edges.begin(), stripe_edges.end(),
                    [&](const auto& stripe) { return stripe.second == segment.label; });
    if (edge_of_stripe && segment.world.a.z() == 0.0 && segment.world.b.z() == 0.0) {
      of_stripes[segment.label].push_back(segment.world.floor());
    } else {
      result.segments.push_back(segment);
    }
  }
  for (const auto& [name, edge_label] : stripe_edges) {
    joinStripesOf(of_stripes[edge_label], name, edge_label, result);
    of_stripes.erase(edge_label);
  }
  return result;
}

}  // namespace vismem
