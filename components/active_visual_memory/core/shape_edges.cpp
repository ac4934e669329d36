#include "active_visual_memory/core/shape_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "active_visual_memory/core/association.h"
#include "active_visual_memory/core/floor_edge.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Where two sides of a painted line end together, as their corners.
struct LineEnd {
  Segment2 edge;
  double along_variance_m2 = 0.0;
};

struct Side {
  Segment2 line;
  Eigen::Vector2d along;
  ExtentEnd a;
  ExtentEnd b;
  std::uint64_t id = 0;
};

Side sideOf(const MemoryElement& element) {
  return {element.line.segment(), element.line.along(), element.line.endA(), element.line.endB(),
          element.value.id};
}

/// The same side with its ends exchanged, for looking at its other end.
Side turned(const Side& side) {
  Side t = side;
  std::swap(t.line.a, t.line.b);
  std::swap(t.a, t.b);
  t.along = -side.along;
  return t;
}

/// The edge from the end b of one side to the end a of the other, square to the line.
std::optional<LineEnd> endBetween(const Side& one, const Side& other, const ShapeEdges::Params& params) {
  if (one.along.dot(other.along) > -std::cos(params.max_angle_rad)) return std::nullopt;
  const double l1 = one.line.length();
  const double l2 = other.line.length();
  const Eigen::Vector2d u = (l1 * one.along - l2 * other.along).normalized();
  const Eigen::Vector2d n{-u.y(), u.x()};
  const double width = std::abs(n.dot(other.line.a - one.line.b));
  if (width < params.min_width_m || width > params.max_width_m) return std::nullopt;
  if (std::min(l1, l2) < 2.0 * width) return std::nullopt;  // a patch
  if (one.b.open || other.a.open || one.b.views < params.min_views || other.a.views < params.min_views) {
    return std::nullopt;
  }
  const double skew = u.dot(other.line.a - one.line.b);
  const double sigma = std::sqrt(one.b.variance_m2 + other.a.variance_m2);
  const double most = std::min(params.most_skew_m, params.max_skew_m + params.max_skew_sigmas * sigma);
  if (std::abs(skew) > most) return std::nullopt;
  const double share = one.b.variance_m2 / (one.b.variance_m2 + other.a.variance_m2);
  return LineEnd{{one.line.b + share * skew * u, other.line.a - (1.0 - share) * skew * u},
                 0.25 * (one.b.variance_m2 + other.a.variance_m2)};
}

/// What lies around a line's end besides its sides.
struct Surroundings {
  bool is_end = true;                   ///< no junction, no gap, not known better already
  std::vector<std::uint64_t> replaced;  ///< what is the end itself, badly seen
  std::optional<std::uint64_t> itself;  ///< what is the end itself, well seen
};

Surroundings lookAround(const LineEnd& end, const Side& one, const Side& other,
                        const std::vector<MemorySegment>& segments, const ShapeEdges::Params& params) {
  Surroundings found;
  const double width = end.edge.length();
  const Eigen::Vector2d outward = one.along;
  for (const MemorySegment& segment : segments) {
    if (segment.id == one.id || segment.id == other.id) continue;
    const Segment2 floor = segment.odom.floor();
    const double angle = lineAngleDifference(floor.direction(), end.edge.direction());
    const double near_a = std::min((floor.a - end.edge.a).norm(), (floor.b - end.edge.a).norm());
    const double near_b = std::min((floor.a - end.edge.b).norm(), (floor.b - end.edge.b).norm());
    const double distance = distanceToSegment(end.edge.middle(), floor);
    if (angle < 0.6) {
      if (distance > params.neighbour_m) continue;
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
    if (std::min(near_a, near_b) <= params.neighbour_m) found.is_end = false;
    // The line goes on behind.
    const bool in_line =
        lineAngleDifference(floor.direction(), one.line.direction()) <= params.max_angle_rad &&
        distanceToLine(end.edge.middle(), floor) <= width;
    const double behind =
        std::max(outward.dot(floor.a - end.edge.middle()), outward.dot(floor.b - end.edge.middle()));
    const double from =
        std::min(outward.dot(floor.a - end.edge.middle()), outward.dot(floor.b - end.edge.middle()));
    if (in_line && behind > params.neighbour_m && from < params.continuation_m) found.is_end = false;
  }
  return found;
}

/// Does the line end where this side of it ends (its end a), with nothing that goes on from there or branches
/// off?
bool endsAlone(const Side& side, double width, double ahead_m, const Side& partner,
               const std::vector<MemorySegment>& segments, const ShapeEdges::Params& params) {
  return std::none_of(segments.begin(), segments.end(), [&](const MemorySegment& segment) {
    if (segment.id == side.id || segment.id == partner.id) return false;
    const Segment2 floor = segment.odom.floor();
    const double near = std::min((floor.a - side.line.a).norm(), (floor.b - side.line.a).norm());
    if (lineAngleDifference(floor.direction(), side.line.direction()) > 0.6) {
      return near <= params.neighbour_m && floor.length() > 1.8 * width + 0.04;
    }
    const auto ahead = [&](const Eigen::Vector2d& p) { return side.along.dot(side.line.a - p); };
    const double from = std::min(ahead(floor.a), ahead(floor.b));
    const double to = std::max(ahead(floor.a), ahead(floor.b));
    return distanceToLine(floor.middle(), side.line) <= 0.5 * width && to > params.neighbour_m &&
           from < ahead_m + params.continuation_m;
  });
}

/// Both sides of a painted line end at one place.
/// @return how far a side's end b lies behind the other's end a [m]; empty when it does not, or when they are
/// no such sides.
std::optional<double> overshoot(const Side& one, const Side& other,
                                const std::vector<MemorySegment>& segments,
                                const ShapeEdges::Params& params) {
  if (one.along.dot(other.along) > -std::cos(params.max_angle_rad)) return std::nullopt;
  const double width = distanceToLine(other.line.middle(), one.line);
  if (width > params.max_width_m) return std::nullopt;  // from afar both sides of a thin line are one
  if (other.a.open || other.a.views < params.min_views) return std::nullopt;
  const double end = one.along.dot(other.line.a - one.line.a);
  const double begin = one.along.dot(other.line.b - one.line.a);
  const double over = one.line.length() - end;
  // Most of the shorter side lies beside the other one, and much more of it than goes on behind.
  const double beside = end - std::max(0.0, begin);
  if (over <= params.most_skew_m || beside < 0.8 * other.line.length() || beside < 2.0 * over) {
    return std::nullopt;
  }
  if (!endsAlone(other, width, over, one, segments, params)) return std::nullopt;
  return over;
}

/// Does its end b lie on a confirmed edge of its kind that crosses it there?
bool reachesALine(const Side& side, const Label& label, const std::vector<MemorySegment>& segments,
                  const ShapeEdges::Params& params) {
  return std::any_of(segments.begin(), segments.end(), [&](const MemorySegment& segment) {
    const Segment2 floor = segment.odom.floor();
    return segment.confirmed && segment.id != side.id && segment.label == label &&
           floor.length() > 2.0 * params.max_width_m &&
           lineAngleDifference(floor.direction(), side.line.direction()) > 0.6 &&
           distanceToSegment(side.line.b, floor) <= params.most_skew_m;
  });
}

/// Of two sides of a painted line that should end together: where the longer one meets another line, the
/// shorter one was not seen to its end. Else the longer one has run into an edge in its line (that of a
/// shadow), and is cut.
/// @return whether the end b of `one`, or the end a of `other`, was moved.
bool endTogether(Side& one, Side& other, const Label& label, const std::vector<MemorySegment>& segments,
                 const ShapeEdges::Params& params) {
  const auto over = overshoot(one, other, segments, params);
  if (!over) return false;
  if (*over <= params.short_sigmas * std::sqrt(other.a.best_m2) ||
      reachesALine(one, label, segments, params)) {
    other.line.a -= *over * other.along;
    other.a.t_m -= std::copysign(*over, other.b.t_m - other.a.t_m);
    other.a.variance_m2 = one.b.variance_m2;
    other.a.open = one.b.open;
    other.a.views = one.b.views;
    return true;
  }
  const double end = one.line.length() - *over;
  one.line.b = one.line.a + end * one.along;
  one.b.t_m = one.a.t_m + std::copysign(end, one.b.t_m - one.a.t_m);
  one.b.variance_m2 = other.a.variance_m2;
  one.b.open = false;
  one.b.views = other.a.views;
  return true;
}

Eigen::Matrix3d covarianceOf(const Eigen::Vector2d& u, double along, double across) {
  const Eigen::Vector2d n{-u.y(), u.x()};
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  P.topLeftCorner<2, 2>() = along * u * u.transpose() + across * n * n.transpose();
  return P;
}

}  // namespace

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
    const auto element = std::find_if(elements.begin(), elements.end(),
                                      [&](const MemoryElement& e) { return e.value.id == segment.id; });
    if (element != elements.end() && segment.confirmed) sides.push_back(&*element);
  }
  std::vector<Side> lines;
  for (const MemoryElement* side : sides) lines.push_back(sideOf(*side));
  // Both sides of paint are as strong; the strip of shadow along a box has two different ones.
  const auto areSidesOfPaint = [&](std::size_t i, std::size_t k, double strength_share) {
    const auto [weak, strong] = std::minmax(sides[i]->strength, sides[k]->strength);
    return i != k && sides[i]->value.label == sides[k]->value.label && weak >= strength_share * strong;
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      // The edge that a side ran into has made it weaker.
      if (!areSidesOfPaint(i, k, params_.overshoot_strength_share)) continue;
      const Label& label = sides[i]->value.label;
      bool moved = endTogether(lines[i], lines[k], label, segments, params_);
      Side one = turned(lines[i]);
      Side other = turned(lines[k]);
      if (endTogether(one, other, label, segments, params_)) {
        lines[i] = turned(one);
        lines[k] = turned(other);
        moved = true;
      }
      if (!moved) continue;
      for (const Side& side : {lines[i], lines[k]}) {
        const auto told = std::find_if(segments.begin(), segments.end(),
                                       [&](const MemorySegment& s) { return s.id == side.id; });
        told->odom.a.head<2>() = side.line.a;
        told->odom.b.head<2>() = side.line.b;
      }
    }
  }
  std::vector<MemorySegment> ends;
  std::vector<std::uint64_t> replaced;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const MemoryElement* first = sides[i];
    const Side& one = lines[i];
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (!areSidesOfPaint(i, k, params_.min_strength_share)) continue;
      const MemoryElement* second = sides[k];
      const Side& other = lines[k];
      if ((one.line.b - other.line.a).norm() > params_.max_width_m + params_.most_skew_m) continue;
      const auto end = endBetween(one, other, params_);
      if (!end) continue;
      const Surroundings around = lookAround(*end, one, other, segments, params_);
      if (!around.is_end) continue;
      if (around.itself) {
        // Its place is well known, its direction is not: a pixel's error on a few pixels.
        const auto told = std::find_if(segments.begin(), segments.end(),
                                       [&](const MemorySegment& s) { return s.id == *around.itself; });
        const Eigen::Vector2d across = end->edge.b - end->edge.a;
        const Eigen::Vector2d u = Eigen::Vector2d(across.y(), -across.x()).normalized();
        const Eigen::Vector2d shift = u * u.dot(told->odom.floor().middle() - end->edge.middle());
        told->odom.a.head<2>() = end->edge.a + shift;
        told->odom.b.head<2>() = end->edge.b + shift;
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
  const LineWidths of_near = nearLineWidths(segments, elements, params_.line_widths);
  for (Primitive& primitive : primitives) {
    if (primitive.kind != PrimitiveKind::kCircle) continue;
    const std::uint64_t circle = primitive.id;
    tellCircle(segments, primitive, of_near, params_.circles, [&](int chord, int rim) {
      return idOf({circle, static_cast<std::uint64_t>(chord), rim}, new_id);
    });
  }
  tellCrossMarks(segments, elements, of_near, params_.course, params_.crosses,
                 [&](std::uint64_t oldest, int n) {
                   return idOf({oldest, 1, -2 - n}, new_id);
                 });
  withdrawShadows(segments, elements, params_.shadows);
  addLineEnds(segments, elements, new_id);
  const LineWidths widths = evenLineWidths(segments, elements, params_.line_widths);
  partAtJunctions(segments, elements, primitives, widths, params_.junctions,
                  [&](std::uint64_t whole, int part) {
                    return idOf({whole, 0, -2 - part}, new_id);
                  });
  meetAtCorners(segments, elements, params_.corners);
  // What is gone and comes back is something new.
  ids_.swap(used_);
}

}  // namespace vismem
