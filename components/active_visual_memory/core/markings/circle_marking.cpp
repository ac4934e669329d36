#include "active_visual_memory/core/markings/circle_marking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr int kInner = 0;
constexpr int kOuter = 1;
constexpr std::array kBothEdges{kInner, kOuter};
/// A line fitted to a shallow arc cuts it at this share of its half length from its middle.
const double kCut = 1.0 / std::sqrt(3.0);

struct Chord {
  const MemorySegment* segment = nullptr;
  double from_rad = 0.0;  ///< of the arc, counter-clockwise
  double turn_rad = 0.0;  ///< >= 0
  double radius_m = 0.0;  ///< of the arc
  double length_m = 0.0;
  bool counter_clockwise = true;
  int edge = kOuter;
};

/// The line of a circle: radius of its middle and width; 0: a single edge.
struct Ring {
  double radius_m = 0.0;
  double width_m = 0.0;
  std::optional<bool> bright;  ///< against the floor, if the width of the label is known

  double radiusOf(int edge) const { return radius_m + (edge == kOuter ? 0.5 : -0.5) * width_m; }
};

/// The brighter side of an edge lies on its left.
int edgeOf(bool counter_clockwise, double radius_m, const Ring& ring) {
  if (ring.bright) return counter_clockwise == *ring.bright ? kOuter : kInner;
  return ring.width_m > 0.0 && radius_m < ring.radius_m ? kInner : kOuter;
}

std::vector<Chord> chordsOf(const std::vector<MemorySegment>& segments, const Eigen::Vector2d& centre,
                            const Ring& ring, const CircleMarkingParams& params) {
  std::vector<Chord> chords;
  for (const MemorySegment& segment : segments) {
    const Segment2 floor = segment.odom.floor();
    Chord chord;
    chord.length_m = floor.length();
    if (chord.length_m > params.max_chord_share * ring.radius_m) continue;
    const Eigen::Vector2d radial = floor.middle() - centre;
    const Eigen::Vector2d along = (floor.b - floor.a).normalized();
    if (std::abs(radial.normalized().dot(along)) > std::sin(params.edge_angle_rad)) continue;
    const Eigen::Vector2d half = 0.5 * kCut * (floor.b - floor.a);
    const double p = (radial - half).norm();
    const double q = (radial + half).norm();
    chord.radius_m = 0.5 * (p + q);
    chord.counter_clockwise = cross2(radial, along) > 0.0;
    chord.edge = edgeOf(chord.counter_clockwise, chord.radius_m, ring);
    const double edge_distance_m = ring.radiusOf(chord.edge);
    if (std::max(std::abs(p - edge_distance_m), std::abs(q - edge_distance_m)) > params.edge_distance_m)
      continue;
    const Eigen::Vector2d first = (chord.counter_clockwise ? floor.a : floor.b) - centre;
    const Eigen::Vector2d last = (chord.counter_clockwise ? floor.b : floor.a) - centre;
    chord.from_rad = std::atan2(first.y(), first.x());
    chord.turn_rad = std::max(0.0, angleDifference(std::atan2(last.y(), last.x()), chord.from_rad));
    chord.segment = &segment;
    chords.push_back(chord);
  }
  return chords;
}

/// Signed width of lines of the label of the circle; 0 if unknown.
double knownWidth(const std::vector<Chord>& chords, const LineWidths& widths) {
  std::map<Label, double> lengths;
  for (const Chord& chord : chords) lengths[chord.segment->label] += chord.length_m;
  const auto most = std::max_element(lengths.begin(), lengths.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == lengths.end()) return 0.0;
  const auto width = widths.find(most->first);
  return width != widths.end() ? width->second : 0.0;
}

/// Middle between both edges: blur moves them by equal amounts.
double middleRadius(const std::vector<Chord>& chords) {
  std::array<double, 2> lengths{};
  std::array<double, 2> sums{};
  for (const Chord& chord : chords) {
    lengths[chord.edge] += chord.length_m;
    sums[chord.edge] += chord.length_m * chord.radius_m;
  }
  return 0.5 * (sums[kInner] / lengths[kInner] + sums[kOuter] / lengths[kOuter]);
}

bool covers(const Chord& chord, double angle_rad) {
  const double in = wrapAngle(angle_rad - chord.from_rad);
  return (in < 0.0 ? in + 2.0 * std::numbers::pi : in) <= chord.turn_rad;
}

const Chord* bestAt(const std::vector<Chord>& chords, int edge, double angle_rad) {
  const Chord* best = nullptr;
  const auto rank = [](const Chord& c) { return std::pair(c.segment->confirmed, c.segment->life); };
  for (const Chord& chord : chords) {
    if (chord.edge != edge || !covers(chord, angle_rad)) continue;
    if (!best || rank(chord) > rank(*best)) best = &chord;
  }
  return best;
}

/// Continues the chord before a gap of at most `most` places.
void closeGaps(std::vector<const Chord*>& places, int most) {
  const int count = static_cast<int>(places.size());
  const std::vector<const Chord*> seen = places;
  for (int k = 0; k < count; ++k) {
    if (!seen[k]) continue;
    int gap = 0;
    while (gap < count && !seen[(k + 1 + gap) % count]) ++gap;
    for (int i = 0; gap <= most && i < gap; ++i) places[(k + 1 + i) % count] = seen[k];
  }
}

}  // namespace

void regularizeCircle(std::vector<MemorySegment>& segments, Primitive& circle, const LineWidths& widths,
                      const CircleMarkingParams& params,
                      const std::function<std::uint64_t(int, int)>& id_of) {
  Ring ring{circle.radius_m, circle.width_m, std::nullopt};
  std::vector<Chord> chords = chordsOf(segments, circle.centre, ring, params);
  if (const double width = knownWidth(chords, widths); width != 0.0) {
    Ring line{circle.radius_m, std::abs(width), width > 0.0};
    std::vector<Chord> of_line = chordsOf(segments, circle.centre, line, params);
    // A circle with one edge only may be a disc.
    const auto has = [&](int edge) {
      return std::any_of(of_line.begin(), of_line.end(), [&](const Chord& c) { return c.edge == edge; });
    };
    if (has(kInner) && has(kOuter)) {
      line.radius_m = middleRadius(of_line);
      ring = line;
      chords = chordsOf(segments, circle.centre, ring, params);
    }
  }
  std::vector<MemorySegment> edges;
  int sure = 0;
  int places = 0;
  for (const int edge : kBothEdges) {
    if (edge == kInner && ring.width_m <= 0.0) continue;
    const double radius = ring.radiusOf(edge);
    const double step = 2.0 * std::acos(std::clamp(1.0 - params.sagitta_m / radius, 0.5, 1.0));
    const int count = std::max(6, static_cast<int>(std::ceil(2.0 * std::numbers::pi / step)));
    const double turn = 2.0 * std::numbers::pi / count;
    // The ends lie as far outside the circle as the middle lies inside.
    const double reach = 2.0 * radius / (1.0 + std::cos(0.5 * turn));
    int left = 0;
    for (const Chord& chord : chords) {
      if (chord.edge == edge) left += chord.counter_clockwise ? 1 : -1;
    }
    std::vector<const Chord*> best(count, nullptr);
    for (int k = 0; k < count; ++k) best[k] = bestAt(chords, edge, (k + 0.5) * turn);
    // A line has both edges all around: the other edge completes a place.
    const auto seen = std::count_if(best.begin(), best.end(), [](const Chord* c) { return c != nullptr; });
    if (ring.width_m > 0.0 && seen >= params.edge_share * count) {
      for (int k = 0; k < count; ++k) {
        if (!best[k]) best[k] = bestAt(chords, edge == kInner ? kOuter : kInner, (k + 0.5) * turn);
      }
    }
    places += count;
    sure += static_cast<int>(
        std::count_if(best.begin(), best.end(), [](const Chord* c) { return c && c->segment->confirmed; }));
    closeGaps(best, static_cast<int>(params.max_gap_rad / turn));
    for (int k = 0; k < count; ++k) {
      if (!best[k]) continue;
      MemorySegment segment = *best[k]->segment;
      segment.id = id_of(k, edge);
      const auto at = [&](double angle) {
        const Eigen::Vector2d p = circle.centre + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        return Eigen::Vector3d(p.x(), p.y(), 0.0);
      };
      segment.odom = {at(k * turn), at((k + 1) * turn)};
      if (left < 0) std::swap(segment.odom.a, segment.odom.b);
      edges.push_back(std::move(segment));
    }
  }
  if (sure < params.confirmed_share * places) return;
  for (MemorySegment& segment : edges) segment.confirmed = true;
  std::vector<std::uint64_t> published;
  for (const Chord& chord : chords) published.push_back(chord.segment->id);
  std::erase_if(segments, [&](const MemorySegment& s) {
    return std::find(published.begin(), published.end(), s.id) != published.end();
  });
  circle.radius_m = ring.radius_m;
  circle.width_m = ring.width_m;
  circle.segments.clear();
  for (const MemorySegment& segment : edges) circle.segments.push_back(segment.id);
  std::sort(circle.segments.begin(), circle.segments.end());
  segments.insert(segments.end(), edges.begin(), edges.end());
}

}  // namespace vismem
