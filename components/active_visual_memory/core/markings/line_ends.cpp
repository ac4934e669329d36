#include "active_visual_memory/core/markings/line_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "active_visual_memory/core/memory/life.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kAgainst = -0.9;          // largest cosine of both directions, asked first
constexpr double kMaxSkew_m = 0.04;        // distance along the line between the ends of both edges: this ..
constexpr double kMaxSkewSigmas = 2.0;     // .. plus this many sigmas of both ends ..
constexpr double kMostSkew_m = 0.10;       // .. at most this
constexpr double kMinStrengthShare = 0.6;  // contrast of the weaker edge over that of the stronger one
constexpr double kOvershootStrengthShare = 0.35;  // the same for an edge that may run on into another one
constexpr int kMinViews = 3;                      // of each of the two ends
constexpr double kNeighbour_m = 0.06;     // a segment that begins within this of a corner makes it a junction
constexpr double kContinuation_m = 0.30;  // a segment in line within this behind an end makes it a gap
constexpr double kAcross_rad = 0.6;       // largest angle between an end edge and its observation

/// A confirmed edge with its ends.
struct Side : PublishedEdge {
  std::array<ExtentEnd, 2> ends;  ///< a, b

  explicit Side(const PublishedEdge& edge)
      : PublishedEdge(edge), ends{element->line.endA(), element->line.endB()} {}
  void moveEnd(bool at_b, const Eigen::Vector2d& to, const ExtentEnd& end) {
    (at_b ? line.b : line.a) = to;
    ends[at_b] = end;
    placeAt(*published, line);
  }
};

/// The end edge from end b of one edge to end a of the other one of a line marking, square to the line.
std::optional<Segment2> endBetween(const Side& one, const Side& other, const LineWidthRange& widths) {
  const Eigen::Vector2d across = other.line.a - one.line.b;
  if (across.norm() > widths.max_m + kMostSkew_m) return std::nullopt;
  if (!lineMarking(one, other, widths.max_m, kMinStrengthShare)) return std::nullopt;
  const Eigen::Vector2d u = (one.length() * one.along - other.length() * other.along).normalized();
  const double width = std::abs(cross2(u, across));
  if (width < widths.min_m || width > widths.max_m) return std::nullopt;
  if (std::min(one.length(), other.length()) < 2.0 * width) return std::nullopt;  // a patch
  const ExtentEnd& end = one.ends[1];
  const ExtentEnd& begin = other.ends[0];
  if (end.censored || begin.censored || std::min(end.views, begin.views) < kMinViews) return std::nullopt;
  const double skew = u.dot(across);
  const double variance = end.variance_m2 + begin.variance_m2;
  if (std::abs(skew) > std::min(kMostSkew_m, kMaxSkew_m + kMaxSkewSigmas * std::sqrt(variance))) {
    return std::nullopt;
  }
  const double share = end.variance_m2 / variance;
  return Segment2{one.line.b + share * skew * u, other.line.a - (1.0 - share) * skew * u};
}

/// Segments around the end of a line.
struct Surroundings {
  bool is_end = true;                        ///< neither junction nor gap
  std::pmr::vector<std::uint64_t> replaced;  ///< unconfirmed observations of the end
  MemorySegment* itself = nullptr;           ///< the confirmed observation of the end
};

/// @param one, other  the end runs from end b of the first to end a of the second.
Surroundings lookAround(const Segment2& end, const PublishedEdge& one, const PublishedEdge& other,
                        std::vector<MemorySegment>& segments, std::pmr::memory_resource* scratch) {
  Surroundings found{.replaced = std::pmr::vector<std::uint64_t>(scratch)};
  const double width = end.length();
  for (MemorySegment& segment : segments) {
    if (&segment == one.published || &segment == other.published) continue;
    const Segment2 floor = segment.odom.floor();
    const double distance = distanceToSegment(end.middle(), floor);
    if (distance > kContinuation_m + kNeighbour_m + width) continue;  // too far for either
    if (lineAngleDifference(floor.direction(), end.direction()) < kAcross_rad) {
      if (distance > kNeighbour_m) continue;
      const bool is_short = floor.length() <= 1.8 * width + 0.04;
      if (is_short && !segment.confirmed) {
        found.replaced.push_back(segment.id);
      } else if (is_short && !found.itself && (floor.b - floor.a).dot(end.b - end.a) > 0.0) {
        found.itself = &segment;
      } else {
        found.is_end = false;  // a line that crosses here
      }
      continue;
    }
    for (const Eigen::Vector2d& corner : {end.a, end.b}) {
      if (std::min((floor.a - corner).norm(), (floor.b - corner).norm()) <= kNeighbour_m)
        found.is_end = false;
    }
    // The line continues behind a gap.
    const bool in_line = lineAngleDifference(floor.direction(), one.line.direction()) <= kMarkingAngle_rad &&
                         distanceToLine(end.middle(), floor) <= width;
    const auto [from, to] =
        std::minmax({one.along.dot(floor.a - end.middle()), one.along.dot(floor.b - end.middle())});
    if (in_line && to > kNeighbour_m && from < kContinuation_m) found.is_end = false;
  }
  return found;
}

/// Makes both edges of a line marking end together, where `one` goes on behind `other`. Where it reaches
/// another line, `other` was not observed to its end and is extended. Else `one` ran on into an edge in its
/// line (a shadow) and is cut.
/// @param at_b  the end of `one`.
void endTogether(Side& one, bool at_b, Side& other, std::vector<MemorySegment>& segments,
                 const LineWidthRange& widths, std::pmr::memory_resource* scratch) {
  const ExtentEnd& stop = other.ends[!at_b];
  const Eigen::Vector2d outward = at_b ? one.along : Eigen::Vector2d(-one.along);
  const double over = outward.dot(one.place(at_b) - other.place(!at_b));
  if (over <= kMostSkew_m || stop.censored || stop.views < kMinViews) return;
  const auto beside = lineMarking(one, other, widths.max_m, kOvershootStrengthShare);
  if (!beside || beside->overlap_m() < std::max(0.8 * other.length(), 2.0 * over)) return;
  const Eigen::Vector2d cut = one.place(at_b) - over * outward;
  const Segment2 end = at_b ? Segment2{cut, other.line.a} : Segment2{other.line.b, cut};
  if (!lookAround(end, at_b ? one : other, at_b ? other : one, segments, scratch).is_end) return;
  const bool reaches_a_line =
      std::any_of(segments.begin(), segments.end(), [&](const MemorySegment& segment) {
        const Segment2 floor = segment.odom.floor();
        return segment.confirmed && &segment != one.published && segment.label == one.published->label &&
               floor.length() > 2.0 * widths.max_m &&
               lineAngleDifference(floor.direction(), one.line.direction()) > kAcross_rad &&
               distanceToSegment(one.place(at_b), floor) <= kMostSkew_m;
      });
  if (reaches_a_line) {
    other.moveEnd(!at_b, other.place(!at_b) + (at_b ? -over : over) * other.along, one.ends[at_b]);
  } else {
    one.moveEnd(at_b, cut, stop);
  }
}

}  // namespace

void closeLineEnds(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> edges,
                   const LineWidthRange& widths,
                   const std::function<std::uint64_t(std::uint64_t, std::uint64_t)>& id_of,
                   std::pmr::memory_resource* scratch) {
  std::pmr::vector<Side> sides(scratch);
  for (const PublishedEdge& edge : edges) {
    if (edge.element && edge.confirmed()) sides.emplace_back(edge);
  }
  for (Side& one : sides) {
    for (Side& other : sides) {
      if (one.along.dot(other.along) > kAgainst) continue;
      for (const bool at_b : {true, false}) endTogether(one, at_b, other, segments, widths, scratch);
    }
  }
  std::pmr::vector<MemorySegment> ends(scratch);
  std::pmr::vector<std::uint64_t> replaced(scratch);
  for (const Side& one : sides) {
    for (const Side& other : sides) {
      const auto end = endBetween(one, other, widths);
      if (!end) continue;
      const Surroundings around = lookAround(*end, one, other, segments, scratch);
      if (!around.is_end) continue;
      if (around.itself) {
        // Its place is well known, its direction is uncertain by a pixel over a few pixels.
        const Eigen::Vector2d u = -turned90(end->b - end->a).normalized();
        const Eigen::Vector2d shift = u * u.dot(around.itself->odom.floor().middle() - end->middle());
        placeAt(*around.itself, {end->a + shift, end->b + shift});
        continue;
      }
      replaced.insert(replaced.end(), around.replaced.begin(), around.replaced.end());
      const MemorySegment& last = *other.published;
      MemorySegment& segment = ends.emplace_back(*one.published);
      segment.id = id_of(segment.id, last.id);
      placeAt(segment, *end);
      segment.P_a = one.published->P_b;
      segment.P_b = last.P_a;
      segment.life = std::min(segment.life, last.life);
      segment.uncertainty = uncertaintyOf(segment.life);
      segment.first_seen_us = std::max(segment.first_seen_us, last.first_seen_us);
      segment.last_seen_us = std::min(segment.last_seen_us, last.last_seen_us);
    }
  }
  eraseSegments(segments, replaced);
  segments.insert(segments.end(), ends.begin(), ends.end());
}

}  // namespace vismem
