#include "active_visual_memory/core/circle_rims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "active_visual_memory/core/floor_edge.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr int kInnerRim = 0;
constexpr int kOuterRim = 1;
constexpr std::array kRims{kInnerRim, kOuterRim};
/// A line fitted to a shallow arc cuts it at this share of its half length from its middle.
const double kCut = 1.0 / std::sqrt(3.0);

struct Chord {
  const MemorySegment* segment = nullptr;
  double from_rad = 0.0;  ///< of the arc, counter-clockwise
  double turn_rad = 0.0;  ///< >= 0
  double radius_m = 0.0;  ///< of the arc
  double length_m = 0.0;
  bool counter_clockwise = true;
  int rim = kOuterRim;
};

/// The line of a circle: the radius of its middle and its width; 0: it is an edge.
struct Ring {
  double radius_m = 0.0;
  double width_m = 0.0;
  std::optional<bool> bright;  ///< against what it is painted on, if the widths of lines tell

  double radiusOf(int rim) const { return radius_m + (rim == kOuterRim ? 0.5 : -0.5) * width_m; }
};

/// The brighter side of an edge lies on its left.
int rimOf(bool counter_clockwise, double radius_m, const Ring& ring) {
  if (ring.bright) return counter_clockwise == *ring.bright ? kOuterRim : kInnerRim;
  return ring.width_m > 0.0 && radius_m < ring.radius_m ? kInnerRim : kOuterRim;
}

std::vector<Chord> chordsOf(const std::vector<MemorySegment>& segments, const Eigen::Vector2d& centre,
                            const Ring& ring, const CircleRimParams& params) {
  std::vector<Chord> chords;
  for (const MemorySegment& segment : segments) {
    const Segment2 floor = segment.odom.floor();
    Chord chord;
    chord.length_m = floor.length();
    if (chord.length_m > params.most_chord_share * ring.radius_m) continue;
    const Eigen::Vector2d radial = floor.middle() - centre;
    const Eigen::Vector2d along = (floor.b - floor.a).normalized();
    if (std::abs(radial.normalized().dot(along)) > std::sin(params.rim_angle_rad)) continue;
    const Eigen::Vector2d half = 0.5 * kCut * (floor.b - floor.a);
    const double p = (radial - half).norm();
    const double q = (radial + half).norm();
    chord.radius_m = 0.5 * (p + q);
    chord.counter_clockwise = cross(radial, along) > 0.0;
    chord.rim = rimOf(chord.counter_clockwise, chord.radius_m, ring);
    const double rim_m = ring.radiusOf(chord.rim);
    if (std::max(std::abs(p - rim_m), std::abs(q - rim_m)) > params.rim_m) continue;
    const Eigen::Vector2d first = (chord.counter_clockwise ? floor.a : floor.b) - centre;
    const Eigen::Vector2d last = (chord.counter_clockwise ? floor.b : floor.a) - centre;
    chord.from_rad = std::atan2(first.y(), first.x());
    chord.turn_rad = std::max(0.0, angleDifference(std::atan2(last.y(), last.x()), chord.from_rad));
    chord.segment = &segment;
    chords.push_back(chord);
  }
  return chords;
}

/// The width that lines of the circle's label have, with their sign; 0 when it is not known.
double knownWidth(const std::vector<Chord>& chords, const LineWidths& widths) {
  std::map<Label, double> lengths;
  for (const Chord& chord : chords) lengths[chord.segment->label] += chord.length_m;
  const auto most = std::max_element(lengths.begin(), lengths.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == lengths.end()) return 0.0;
  const auto width = widths.find(most->first);
  return width != widths.end() ? width->second : 0.0;
}

/// The middle between both rims; blur moves them by as much towards each other or apart.
double middleRadius(const std::vector<Chord>& chords) {
  std::array<double, 2> lengths{};
  std::array<double, 2> sums{};
  for (const Chord& chord : chords) {
    lengths[chord.rim] += chord.length_m;
    sums[chord.rim] += chord.length_m * chord.radius_m;
  }
  return 0.5 * (sums[kInnerRim] / lengths[kInnerRim] + sums[kOuterRim] / lengths[kOuterRim]);
}

bool covers(const Chord& chord, double angle_rad) {
  const double in = wrapAngle(angle_rad - chord.from_rad);
  return (in < 0.0 ? in + 2.0 * std::numbers::pi : in) <= chord.turn_rad;
}

const Chord* bestAt(const std::vector<Chord>& chords, int rim, double angle_rad) {
  const Chord* best = nullptr;
  const auto rank = [](const Chord& c) { return std::pair(c.segment->confirmed, c.segment->life); };
  for (const Chord& chord : chords) {
    if (chord.rim != rim || !covers(chord, angle_rad)) continue;
    if (!best || rank(chord) > rank(*best)) best = &chord;
  }
  return best;
}

/// Between two places of a rim that were seen goes on what was seen before the gap.
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

void tellCircle(std::vector<MemorySegment>& segments, Primitive& circle, const LineWidths& widths,
                const CircleRimParams& params, const std::function<std::uint64_t(int, int)>& id_of) {
  Ring ring{circle.radius_m, circle.width_m, std::nullopt};
  std::vector<Chord> chords = chordsOf(segments, circle.centre, ring, params);
  if (const double width = knownWidth(chords, widths); width != 0.0) {
    Ring line{circle.radius_m, std::abs(width), width > 0.0};
    std::vector<Chord> of_line = chordsOf(segments, circle.centre, line, params);
    // What has one rim only may be a disc.
    const auto has = [&](int rim) {
      return std::any_of(of_line.begin(), of_line.end(), [&](const Chord& c) { return c.rim == rim; });
    };
    if (has(kInnerRim) && has(kOuterRim)) {
      line.radius_m = middleRadius(of_line);
      ring = line;
      chords = chordsOf(segments, circle.centre, ring, params);
    }
  }
  std::vector<MemorySegment> rims;
  int sure = 0;
  int places = 0;
  for (const int rim : kRims) {
    if (rim == kInnerRim && ring.width_m <= 0.0) continue;
    const double radius = ring.radiusOf(rim);
    const double step = 2.0 * std::acos(std::clamp(1.0 - params.sagitta_m / radius, 0.5, 1.0));
    const int count = std::max(6, static_cast<int>(std::ceil(2.0 * std::numbers::pi / step)));
    const double turn = 2.0 * std::numbers::pi / count;
    // Ends as far outside the circle as the middle is inside.
    const double reach = 2.0 * radius / (1.0 + std::cos(0.5 * turn));
    int left = 0;
    for (const Chord& chord : chords) {
      if (chord.rim == rim) left += chord.counter_clockwise ? 1 : -1;
    }
    std::vector<const Chord*> best(count, nullptr);
    for (int k = 0; k < count; ++k) best[k] = bestAt(chords, rim, (k + 0.5) * turn);
    // The line has both rims all around: where one was seen is the other one, too.
    const auto seen = std::count_if(best.begin(), best.end(), [](const Chord* c) { return c != nullptr; });
    if (ring.width_m > 0.0 && seen >= params.rim_share * count) {
      for (int k = 0; k < count; ++k) {
        if (!best[k]) best[k] = bestAt(chords, rim == kInnerRim ? kOuterRim : kInnerRim, (k + 0.5) * turn);
      }
    }
    places += count;
    sure += static_cast<int>(
        std::count_if(best.begin(), best.end(), [](const Chord* c) { return c && c->segment->confirmed; }));
    closeGaps(best, static_cast<int>(params.most_gap_rad / turn));
    for (int k = 0; k < count; ++k) {
      if (!best[k]) continue;
      MemorySegment segment = *best[k]->segment;
      segment.id = id_of(k, rim);
      const auto at = [&](double angle) {
        const Eigen::Vector2d p = circle.centre + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        return Eigen::Vector3d(p.x(), p.y(), 0.0);
      };
      segment.odom = {at(k * turn), at((k + 1) * turn)};
      if (left < 0) std::swap(segment.odom.a, segment.odom.b);
      rims.push_back(std::move(segment));
    }
  }
  if (sure < params.confirmed_share * places) return;
  for (MemorySegment& segment : rims) segment.confirmed = true;
  std::vector<std::uint64_t> told;
  for (const Chord& chord : chords) told.push_back(chord.segment->id);
  std::erase_if(segments, [&](const MemorySegment& s) {
    return std::find(told.begin(), told.end(), s.id) != told.end();
  });
  circle.radius_m = ring.radius_m;
  circle.width_m = ring.width_m;
  circle.segments.clear();
  for (const MemorySegment& segment : rims) circle.segments.push_back(segment.id);
  std::sort(circle.segments.begin(), circle.segments.end());
  segments.insert(segments.end(), rims.begin(), rims.end());
}

}  // namespace vismem
