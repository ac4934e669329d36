#include "active_visual_memory/core/markings/circle_marking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr int kInner = 0;
constexpr int kOuter = 1;
constexpr std::array kBothEdges{kInner, kOuter};
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

std::pmr::vector<Chord> chordsOf(const std::vector<MemorySegment>& segments, const Eigen::Vector2d& centre,
                                 const Ring& ring, const CircleMarkingParams& params,
                                 std::pmr::memory_resource* scratch) {
  std::pmr::vector<Chord> chords(scratch);
  for (const MemorySegment& segment : segments) {
    const Segment2 floor = segment.odom.floor();
    Chord chord;
    chord.length_m = floor.length();
    if (chord.length_m > params.max_chord_share * ring.radius_m) continue;
    const Eigen::Vector2d radial = floor.middle() - centre;
    const Eigen::Vector2d along = (floor.b - floor.a).normalized();
    if (std::abs(radial.normalized().dot(along)) > std::sin(params.edge_angle_rad)) continue;
    const Segment2 cut = arcPoints(floor);
    const double p = (cut.a - centre).norm();
    const double q = (cut.b - centre).norm();
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

/// The line of a circle whose label has lines of a known width; without one the single edge that was found,
/// or both. A circle with one edge only may be a disc.
Ring ringOf(const std::vector<MemorySegment>& segments, const Primitive& circle, const LineWidths& widths,
            const CircleMarkingParams& params, std::pmr::memory_resource* scratch) {
  const Ring found{circle.radius_m, circle.width_m, std::nullopt};
  const std::pmr::vector<Chord> chords = chordsOf(segments, circle.centre, found, params, scratch);
  const auto longest = std::max_element(
      chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.length_m < b.length_m; });
  const auto width = longest != chords.end() ? widths.find(longest->segment->label) : widths.end();
  if (width == widths.end()) return found;
  Ring line{circle.radius_m, std::abs(width->second), width->second > 0.0};
  std::array<double, 2> lengths{};
  std::array<double, 2> sums{};
  for (const Chord& chord : chordsOf(segments, circle.centre, line, params, scratch)) {
    lengths[chord.edge] += chord.length_m;
    sums[chord.edge] += chord.length_m * chord.radius_m;
  }
  if (lengths[kInner] == 0.0 || lengths[kOuter] == 0.0) return found;
  // The middle between both edges: blur moves them by equal amounts.
  line.radius_m = 0.5 * (sums[kInner] / lengths[kInner] + sums[kOuter] / lengths[kOuter]);
  return line;
}

bool covers(const Chord& chord, double angle_rad) {
  const double in = wrapAngle(angle_rad - chord.from_rad);
  return (in < 0.0 ? in + 2.0 * std::numbers::pi : in) <= chord.turn_rad;
}

const Chord* bestAt(std::span<const Chord> chords, int edge, double angle_rad) {
  const Chord* best = nullptr;
  const auto rank = [](const Chord& c) { return std::pair(c.segment->confirmed, c.segment->life); };
  for (const Chord& chord : chords) {
    if (chord.edge != edge || !covers(chord, angle_rad)) continue;
    if (!best || rank(chord) > rank(*best)) best = &chord;
  }
  return best;
}

/// Continues the chord before a gap of at most `most` places.
void closeGaps(std::pmr::vector<const Chord*>& places, int most) {
  const int count = static_cast<int>(places.size());
  const std::pmr::vector<const Chord*> seen(places, places.get_allocator());
  for (int k = 0; k < count; ++k) {
    if (!seen[k]) continue;
    int gap = 0;
    while (gap < count && !seen[(k + 1 + gap) % count]) ++gap;
    for (int i = 0; gap <= most && i < gap; ++i) places[(k + 1 + i) % count] = seen[k];
  }
}

/// The chord that shows each of `count` places of an edge, if any. A line has both edges all around: where
/// one was not observed, the other one completes it.
std::pmr::vector<const Chord*> placesOf(const std::pmr::vector<Chord>& chords, int edge, int count,
                                        bool is_line, const CircleMarkingParams& params) {
  const double turn = 2.0 * std::numbers::pi / count;
  std::pmr::vector<const Chord*> places(count, nullptr, chords.get_allocator());
  for (int k = 0; k < count; ++k) places[k] = bestAt(chords, edge, (k + 0.5) * turn);
  const auto seen = std::count_if(places.begin(), places.end(), [](const Chord* c) { return c != nullptr; });
  if (!is_line || seen < params.edge_share * count) return places;
  for (int k = 0; k < count; ++k) {
    if (!places[k]) places[k] = bestAt(chords, edge == kInner ? kOuter : kInner, (k + 0.5) * turn);
  }
  return places;
}

}  // namespace

void regularizeCircle(std::vector<MemorySegment>& segments, Primitive& circle, const LineWidths& widths,
                      const CircleMarkingParams& params, const std::function<std::uint64_t(int, int)>& id_of,
                      std::pmr::memory_resource* scratch) {
  const Ring ring = ringOf(segments, circle, widths, params, scratch);
  const std::pmr::vector<Chord> chords = chordsOf(segments, circle.centre, ring, params, scratch);
  std::pmr::vector<MemorySegment> edges(scratch);
  int sure = 0;
  int all = 0;
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
    std::pmr::vector<const Chord*> places = placesOf(chords, edge, count, ring.width_m > 0.0, params);
    all += count;
    sure += static_cast<int>(std::count_if(places.begin(), places.end(),
                                           [](const Chord* c) { return c && c->segment->confirmed; }));
    closeGaps(places, static_cast<int>(params.max_gap_rad / turn));
    for (int k = 0; k < count; ++k) {
      if (!places[k]) continue;
      MemorySegment& segment = edges.emplace_back(*places[k]->segment);
      segment.id = id_of(k, edge);
      segment.confirmed = true;
      const auto at = [&](double angle) {
        return Eigen::Vector2d(circle.centre + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      };
      Segment2 chord{at(k * turn), at((k + 1) * turn)};
      if (left < 0) std::swap(chord.a, chord.b);
      placeAt(segment, chord);
    }
  }
  if (sure < params.confirmed_share * all) return;
  std::pmr::vector<std::uint64_t> replaced(scratch);
  for (const Chord& chord : chords) replaced.push_back(chord.segment->id);
  eraseSegments(segments, replaced);
  circle.radius_m = ring.radius_m;
  circle.width_m = ring.width_m;
  circle.segments.clear();
  for (const MemorySegment& segment : edges) circle.segments.push_back(segment.id);
  std::sort(circle.segments.begin(), circle.segments.end());
  segments.insert(segments.end(), edges.begin(), edges.end());
}

}  // namespace vismem
