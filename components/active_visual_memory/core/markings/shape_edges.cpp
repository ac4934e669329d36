#include "active_visual_memory/core/markings/shape_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kMaxAngle_rad = 0.10;     // between both edges of a line
constexpr double kMaxSkew_m = 0.04;        // distance along the line between the ends of both edges: this ..
constexpr double kMaxSkewSigmas = 2.0;     // .. plus this many sigmas of both ends ..
constexpr double kMostSkew_m = 0.10;       // .. at most this
constexpr double kMinStrengthShare = 0.6;  // contrast of the weaker edge over that of the stronger one
constexpr double kOvershootStrengthShare = 0.35;  // the same for an edge that may run on into another one
constexpr int kMinViews = 3;                      // of each of the two ends
constexpr double kNeighbour_m = 0.06;     // a segment that begins within this of a corner makes it a junction
constexpr double kContinuation_m = 0.30;  // a segment in line within this behind an end makes it a gap

/// The end of a line marking: its two corners.
struct LineEnd {
  Segment2 edge;
  double along_variance_m2 = 0.0;
};

struct MarkingEdge {
  Segment2 line;
  Eigen::Vector2d along;
  ExtentEnd a;
  ExtentEnd b;
  std::uint64_t id = 0;
};

MarkingEdge markingEdge(const MemoryElement& element) {
  return {element.line.segment(), element.line.along(), element.line.endA(), element.line.endB(),
          element.value.id};
}

/// The same edge with its ends exchanged.
MarkingEdge turned(const MarkingEdge& side) {
  MarkingEdge t = side;
  std::swap(t.line.a, t.line.b);
  std::swap(t.a, t.b);
  t.along = -side.along;
  return t;
}

/// The end edge from end b of one edge to end a of the other, antiparallel one, square to the line.
std::optional<LineEnd> endBetween(const MarkingEdge& one, const MarkingEdge& other,
                                  const ShapeEdges::Params& params) {
  const double l1 = one.line.length();
  const double l2 = other.line.length();
  const Eigen::Vector2d u = (l1 * one.along - l2 * other.along).normalized();
  const Eigen::Vector2d n = turned90(u);
  const double width = std::abs(n.dot(other.line.a - one.line.b));
  if (width < params.line_width.min_m || width > params.line_width.max_m) return std::nullopt;
  if (std::min(l1, l2) < 2.0 * width) return std::nullopt;  // a patch
  if (one.b.censored || other.a.censored || one.b.views < kMinViews || other.a.views < kMinViews) {
    return std::nullopt;
  }
  const double skew = u.dot(other.line.a - one.line.b);
  const double sigma = std::sqrt(one.b.variance_m2 + other.a.variance_m2);
  const double most = std::min(kMostSkew_m, kMaxSkew_m + kMaxSkewSigmas * sigma);
  if (std::abs(skew) > most) return std::nullopt;
  const double share = one.b.variance_m2 / (one.b.variance_m2 + other.a.variance_m2);
  return LineEnd{{one.line.b + share * skew * u, other.line.a - (1.0 - share) * skew * u},
                 0.25 * (one.b.variance_m2 + other.a.variance_m2)};
}

/// Segments around the end of a line.
struct Surroundings {
  bool is_end = true;                   ///< neither junction nor gap
  std::vector<std::uint64_t> replaced;  ///< unconfirmed observations of the end
  std::optional<std::uint64_t> itself;  ///< the confirmed observation of the end
};

Surroundings lookAround(const LineEnd& end, const MarkingEdge& one, const MarkingEdge& other,
                        const std::vector<MemorySegment>& segments) {
  Surroundings found;
  const double width = end.edge.length();
  const Eigen::Vector2d outward = one.along;
  for (const MemorySegment& segment : segments) {
    if (segment.id == one.id || segment.id == other.id) continue;
    const Segment2 floor = segment.odom.floor();
    const double near_a = std::min((floor.a - end.edge.a).norm(), (floor.b - end.edge.a).norm());
    const double near_b = std::min((floor.a - end.edge.b).norm(), (floor.b - end.edge.b).norm());
    const double distance = distanceToSegment(end.edge.middle(), floor);
    // The line continues behind a gap, if the direction is its own.
    const double behind =
        std::max(outward.dot(floor.a - end.edge.middle()), outward.dot(floor.b - end.edge.middle()));
    const double from =
        std::min(outward.dot(floor.a - end.edge.middle()), outward.dot(floor.b - end.edge.middle()));
    const bool in_line =
        behind > kNeighbour_m && from < kContinuation_m && distanceToLine(end.edge.middle(), floor) <= width;
    // Directions cost more than places.
    if (std::min({near_a, near_b, distance}) > kNeighbour_m && !in_line) continue;
    const double angle = lineAngleDifference(floor.direction(), end.edge.direction());
    if (angle < 0.6) {
      if (distance > kNeighbour_m) continue;
      if (floor.length() <= 1.8 * width + 0.04 && !segment.confirmed) {
        found.replaced.push_back(segment.id);
      } else if (floor.length() <= 1.8 * width + 0.04 && !found.itself &&
                 (floor.b - floor.a).dot(end.edge.b - end.edge.a) > 0.0) {
        found.itself = segment.id;
      } else {
        found.is_end = false;  // a line that crosses here
      }
      continue;
    }
    if (std::min(near_a, near_b) <= kNeighbour_m) found.is_end = false;
    if (in_line && lineAngleDifference(floor.direction(), one.line.direction()) <= kMaxAngle_rad)
      found.is_end = false;
  }
  return found;
}

/// Whether the line ends at end a of this edge: no segment continues it or branches off.
bool endsAlone(const MarkingEdge& side, double width, double ahead_m, const MarkingEdge& partner,
               const std::vector<MemorySegment>& segments) {
  return std::none_of(segments.begin(), segments.end(), [&](const MemorySegment& segment) {
    if (segment.id == side.id || segment.id == partner.id) return false;
    const Segment2 floor = segment.odom.floor();
    const double near = std::min((floor.a - side.line.a).norm(), (floor.b - side.line.a).norm());
    const bool branches = near <= kNeighbour_m && floor.length() > 1.8 * width + 0.04;
    const auto ahead = [&](const Eigen::Vector2d& p) { return side.along.dot(side.line.a - p); };
    const double from = std::min(ahead(floor.a), ahead(floor.b));
    const double to = std::max(ahead(floor.a), ahead(floor.b));
    const bool continues = to > kNeighbour_m && from < ahead_m + kContinuation_m &&
                           distanceToLine(floor.middle(), side.line) <= 0.5 * width;
    if (!branches && !continues) return false;
    return lineAngleDifference(floor.direction(), side.line.direction()) > 0.6 ? branches : continues;
  });
}

/// Both edges of a line marking end at one place. @param one, other  antiparallel.
/// @return by how much end b of `one` lies behind end a of `other` [m]; empty if it does not, or if they are
/// not the two edges of a line.
std::optional<double> overshoot(const MarkingEdge& one, const MarkingEdge& other,
                                const std::vector<MemorySegment>& segments) {
  const double width = distanceToLine(other.line.middle(), one.line);
  if (other.a.censored || other.a.views < kMinViews) return std::nullopt;
  const double end = one.along.dot(other.line.a - one.line.a);
  const double begin = one.along.dot(other.line.b - one.line.a);
  const double over = one.line.length() - end;
  // Most of the shorter edge lies beside the other one, and at least twice the overshoot.
  const double beside = end - std::max(0.0, begin);
  if (over <= kMostSkew_m || beside < 0.8 * other.line.length() || beside < 2.0 * over) {
    return std::nullopt;
  }
  if (!endsAlone(other, width, over, one, segments)) return std::nullopt;
  return over;
}

/// Whether end b lies on a confirmed edge of its label that crosses it.
bool reachesALine(const MarkingEdge& side, const Label& label, const std::vector<MemorySegment>& segments,
                  const ShapeEdges::Params& params) {
  return std::any_of(segments.begin(), segments.end(), [&](const MemorySegment& segment) {
    const Segment2 floor = segment.odom.floor();
    return segment.confirmed && segment.id != side.id && segment.label == label &&
           floor.length() > 2.0 * params.line_width.max_m &&
           lineAngleDifference(floor.direction(), side.line.direction()) > 0.6 &&
           distanceToSegment(side.line.b, floor) <= kMostSkew_m;
  });
}

/// Makes both edges of a line end together. Where the longer one reaches another line, the shorter one was
/// not observed to its end and is extended. Else the longer one ran on into an edge in its line (a shadow)
/// and is cut.
/// @return whether end b of `one` or end a of `other` was moved.
bool endTogether(MarkingEdge& one, MarkingEdge& other, const Label& label,
                 const std::vector<MemorySegment>& segments, const ShapeEdges::Params& params) {
  const auto over = overshoot(one, other, segments);
  if (!over) return false;
  if (*over <= params.short_sigmas * std::sqrt(other.a.best_m2) ||
      reachesALine(one, label, segments, params)) {
    other.line.a -= *over * other.along;
    other.a.t_m -= std::copysign(*over, other.b.t_m - other.a.t_m);
    other.a.variance_m2 = one.b.variance_m2;
    other.a.censored = one.b.censored;
    other.a.views = one.b.views;
    return true;
  }
  const double end = one.line.length() - *over;
  one.line.b = one.line.a + end * one.along;
  one.b.t_m = one.a.t_m + std::copysign(end, one.b.t_m - one.a.t_m);
  one.b.variance_m2 = other.a.variance_m2;
  one.b.censored = false;
  one.b.views = other.a.views;
  return true;
}

Eigen::Matrix3d covarianceOf(const Eigen::Vector2d& u, double along, double across) {
  const Eigen::Vector2d n = turned90(u);
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  P.topLeftCorner<2, 2>() = along * u * u.transpose() + across * n * n.transpose();
  return P;
}

}  // namespace

void ShapeEdges::Params::visit(ParameterVisitor& v) {
  v.real(basic("Line.MinimumWidth_m", "width of line markings; a measured width may be a third less"),
         line_width.min_m, 0.001, 5.0);
  v.real(basic("Line.MaximumWidth_m", "the same, at most"), line_width.max_m, 0.001, 5.0);
  v.require("Line.MinimumWidth_m", line_width.min_m < line_width.max_m, "must be less than",
            "Line.MaximumWidth_m");
  bool far_lines = false;
  v.flag(
      expert("FarLines",
             "for distant narrow lines: ends within two sigmas of their corner, edges a pixel further apart, "
             "junctions by one edge of a line, cross spots"),
      far_lines);
  if (far_lines) {
    // Distant ends are uncertain by two pixels instead of one.
    short_sigmas = corners.reach_sigmas = junctions.reach_sigmas = 2.0;
    corners.most_reach_m = junctions.most_reach_m = 0.25;
    line_widths.blur_px = 1.0;
    junctions.by_one_side = true;
    crosses.enabled = true;
  }
  v.alias("PartAtJunctions", "SplitAtJunctions");
  v.flag(expert("SplitAtJunctions", "split edges where lines join or cross"), junctions.enabled);
  v.flag(expert("EvenLineWidths", "give distant lines the width of near ones of their label"),
         line_widths.enabled);
}

ShapeEdges::ShapeEdges(const Params& params) : params_(params) {
  params_.line_widths.range = params_.junctions.range = params_.line_width;
}

std::uint64_t ShapeEdges::idOf(const Key& key, const NewId& new_id) {
  const auto known = ids_.find(key);
  const std::uint64_t id = known != ids_.end() ? known->second : new_id();
  used_.emplace(key, id);
  return id;
}

void ShapeEdges::addLineEnds(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                             const NewId& new_id) {
  std::vector<const MemoryElement*> sides;
  for (const MemorySegment& segment : segments) {
    const MemoryElement* element = findElement(elements, segment.id);
    if (element && segment.confirmed) sides.push_back(element);
  }
  std::vector<MarkingEdge> lines;
  for (const MemoryElement* side : sides) lines.push_back(markingEdge(*side));
  // Both edges of paint are antiparallel and have equal contrast; those of a shadow strip differ.
  const double least_against = -std::cos(kMaxAngle_rad);
  const auto areEdgesOfOneMarking = [&](std::size_t i, std::size_t k, double strength_share) {
    if (lines[i].along.dot(lines[k].along) > least_against) return false;
    const auto [weak, strong] = std::minmax(sides[i]->strength, sides[k]->strength);
    return sides[i]->value.label == sides[k]->value.label && weak >= strength_share * strong;
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      // Running on into another edge lowers the mean contrast.
      if (!areEdgesOfOneMarking(i, k, kOvershootStrengthShare)) continue;
      // Edges of a distant narrow line coincide.
      if (distanceToLine(lines[k].line.middle(), lines[i].line) > params_.line_width.max_m) continue;
      const Label& label = sides[i]->value.label;
      bool moved = endTogether(lines[i], lines[k], label, segments, params_);
      MarkingEdge one = turned(lines[i]);
      MarkingEdge other = turned(lines[k]);
      if (endTogether(one, other, label, segments, params_)) {
        lines[i] = turned(one);
        lines[k] = turned(other);
        moved = true;
      }
      if (!moved) continue;
      for (const MarkingEdge& side : {lines[i], lines[k]}) {
        const auto published = std::find_if(segments.begin(), segments.end(),
                                            [&](const MemorySegment& s) { return s.id == side.id; });
        published->odom.a.head<2>() = side.line.a;
        published->odom.b.head<2>() = side.line.b;
      }
    }
  }
  std::vector<MemorySegment> ends;
  std::vector<std::uint64_t> replaced;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const MemoryElement* first = sides[i];
    const MarkingEdge& one = lines[i];
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (!areEdgesOfOneMarking(i, k, kMinStrengthShare)) continue;
      const MemoryElement* second = sides[k];
      const MarkingEdge& other = lines[k];
      if ((one.line.b - other.line.a).norm() > params_.line_width.max_m + kMostSkew_m) continue;
      const auto end = endBetween(one, other, params_);
      if (!end) continue;
      const Surroundings around = lookAround(*end, one, other, segments);
      if (!around.is_end) continue;
      if (around.itself) {
        // Its place is well known, its direction is uncertain by a pixel over a few pixels.
        const auto published = std::find_if(segments.begin(), segments.end(),
                                            [&](const MemorySegment& s) { return s.id == *around.itself; });
        const Eigen::Vector2d across = end->edge.b - end->edge.a;
        const Eigen::Vector2d u = Eigen::Vector2d(across.y(), -across.x()).normalized();
        const Eigen::Vector2d shift = u * u.dot(published->odom.floor().middle() - end->edge.middle());
        published->odom.a.head<2>() = end->edge.a + shift;
        published->odom.b.head<2>() = end->edge.b + shift;
        continue;
      }
      replaced.insert(replaced.end(), around.replaced.begin(), around.replaced.end());
      MemorySegment segment = first->value;
      segment.id = idOf({one.id, other.id, -1}, new_id);
      segment.odom = {{end->edge.a.x(), end->edge.a.y(), 0.0}, {end->edge.b.x(), end->edge.b.y(), 0.0}};
      segment.P_a = covarianceOf(one.along, end->along_variance_m2, first->line.offsetVariance(one.b.t_m));
      segment.P_b = covarianceOf(one.along, end->along_variance_m2, second->line.offsetVariance(other.a.t_m));
      segment.life = std::min(first->value.life, second->value.life);
      segment.uncertainty = uncertaintyOf(segment.life);
      segment.first_seen_us = std::max(first->value.first_seen_us, second->value.first_seen_us);
      segment.last_seen_us = std::min(first->value.last_seen_us, second->value.last_seen_us);
      ends.push_back(std::move(segment));
    }
  }
  std::erase_if(segments, [&](const MemorySegment& s) {
    return std::find(replaced.begin(), replaced.end(), s.id) != replaced.end();
  });
  segments.insert(segments.end(), ends.begin(), ends.end());
}

void ShapeEdges::complete(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          std::vector<Primitive>& primitives, const NewId& new_id) {
  if (!params_.enabled) return;
  used_.clear();
  const LineWidths of_near = measureLineWidths(segments, elements, params_.line_widths);
  for (Primitive& primitive : primitives) {
    if (primitive.kind != PrimitiveKind::kCircle) continue;
    const std::uint64_t circle = primitive.id;
    regularizeCircle(segments, primitive, of_near, params_.circles, [&](int chord, int edge) {
      return idOf({circle, static_cast<std::uint64_t>(chord), edge}, new_id);
    });
  }
  replaceCrossSpots(segments, elements, of_near, params_.dominant_direction, params_.crosses,
                    [&](std::uint64_t oldest, int n) {
                      return idOf({oldest, 1, -2 - n}, new_id);
                    });
  withdrawShadows(segments, elements, params_.shadows);
  addLineEnds(segments, elements, new_id);
  const LineWidths widths = equalizeLineWidths(segments, elements, params_.line_widths);
  splitAtJunctions(segments, elements, primitives, widths, params_.junctions,
                   [&](std::uint64_t whole, int part) {
                     return idOf({whole, 0, -2 - part}, new_id);
                   });
  joinAtCorners(segments, elements, params_.corners);
  // An edge that returns after an absence gets a new id.
  ids_.swap(used_);
}

}  // namespace vismem
