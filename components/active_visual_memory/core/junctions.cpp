#include "active_visual_memory/core/junctions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "active_visual_memory/core/floor_edge.h"
#include "active_visual_memory/core/line_sides.h"

namespace vismem {
namespace {

/// A stretch along an edge from its end a [m].
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

struct Edge {
  std::size_t segment = 0;  ///< index of what it was taken from
  bool confirmed = true;
  const MemoryElement* element = nullptr;  ///< null for what was only told (rims of circles, ends of lines)
  Eigen::Vector2d a;
  Eigen::Vector2d along;
  double length = 0.0;
  Stretch told;  ///< its ends, as far as junctions tell them better
  std::vector<Stretch> gaps;

  Segment2 line() const { return {a, a + length * along}; }
  double tOf(const Eigen::Vector2d& p) const { return along.dot(p - a); }
  /// Where another edge's line crosses this one's.
  double crossing(const Edge& other) const {
    return cross(other.a - a, other.along) / cross(along, other.along);
  }
  double reach(bool at_b, const JunctionParams& params) const {
    const double best = element ? (at_b ? element->line.endB() : element->line.endA()).best_m2 : 0.0;
    return std::min(params.most_reach_m, params.reach_m + params.reach_sigmas * std::sqrt(best));
  }
};

/// A painted line by one of its sides, which is confirmed.
struct Line {
  std::size_t one = 0;
  std::optional<std::size_t> other;
  double width_m = 0.0;  ///< > 0: the paint lies to the left of each side; < 0: to the right
};

std::optional<Line> lineOf(const std::vector<Edge>& edges, std::size_t i, std::size_t k,
                           const std::vector<MemorySegment>& segments, const JunctionParams& params) {
  const Edge& one = edges[i];
  const Edge& other = edges[k];
  if (one.along.dot(other.along) > -std::cos(params.max_angle_rad)) return std::nullopt;
  if (segments[one.segment].label != segments[other.segment].label) return std::nullopt;
  const auto beside = sideBySide(one.line(), other.line(), params.max_angle_rad);
  if (!beside || beside->to_m - beside->from_m < params.body_m) return std::nullopt;
  const double width = std::abs(beside->left_m);
  if (width < params.min_width_m || width > params.max_width_m) return std::nullopt;
  const auto [weak, strong] = std::minmax(one.element->strength, other.element->strength);
  if (weak < params.min_strength_share * strong) return std::nullopt;
  return Line{i, k, beside->left_m};
}

/// How a side of a line meets an edge.
struct Meeting {
  double at = 0.0;    ///< along the edge
  bool ends = false;  ///< the side ends here ..
  bool at_b = false;  ///< .. with its end b; else it goes on across the edge
  double side_t = 0.0;
};

/// @param outward the direction that leads away from the edge's paint.
std::optional<Meeting> meet(const Edge& edge, const Edge& side, const Eigen::Vector2d& outward,
                            const JunctionParams& params) {
  if (std::abs(cross(edge.along, side.along)) < std::sin(params.min_crossing_rad)) return std::nullopt;
  Meeting meeting;
  meeting.at = edge.crossing(side);
  meeting.side_t = side.crossing(edge);
  const bool leads_outward = side.along.dot(outward) > 0.0;
  const double outside = leads_outward ? side.length - meeting.side_t : meeting.side_t;
  const double inside = leads_outward ? meeting.side_t : side.length - meeting.side_t;
  meeting.at_b = !leads_outward;
  const double reach = side.reach(meeting.at_b, params);
  if (outside < params.body_m || inside < -reach) return std::nullopt;
  meeting.ends = inside <= reach;
  return meeting;
}

void partByLine(std::vector<Edge>& edges, std::size_t index, const Line& line, const JunctionParams& params) {
  Edge& edge = edges[index];
  const Eigen::Vector2d outward =
      -std::copysign(1.0, line.width_m) * Eigen::Vector2d(-edge.along.y(), edge.along.x());
  Edge& side = edges[line.one];
  const auto one = meet(edge, side, outward, params);
  if (!one) return;
  const auto other = line.other ? meet(edge, edges[*line.other], outward, params) : std::nullopt;
  if (!other && !params.by_one_side) return;
  // Not seen so far, the other side lies beside this one all the same.
  const double across = cross(side.along, edge.along);
  const double beside = other ? other->at : one->at + line.width_m / across;
  const Stretch gap{std::min(one->at, beside), std::max(one->at, beside)};
  if (gap.to - gap.from > 2.0 * params.max_width_m || gap.to <= 0.0 || gap.from >= edge.length) return;
  edge.gaps.push_back(gap);
  if (one->ends) (one->at_b ? side.told.to : side.told.from) = one->side_t;
}

/// @param middle of the circle, along the edge. @param far its outer rim from there.
void tellEndsAtCircle(Edge& edge, double middle, double far, const JunctionParams& params) {
  const double before = edge.told.from - (middle + far);
  if (before > 0.0 && before <= edge.reach(false, params)) edge.told.from = middle + far;
  const double behind = middle - far - edge.told.to;
  if (behind > 0.0 && behind <= edge.reach(true, params)) edge.told.to = middle - far;
}

void partByCircle(Edge& edge, const Primitive& circle, const JunctionParams& params) {
  const double off = std::abs(cross(edge.along, circle.centre - edge.a));
  if (off > params.max_off_centre_share * circle.radius_m) return;
  const double middle = edge.tOf(circle.centre);
  const double outer = circle.radius_m + 0.5 * circle.width_m;
  const double inner = circle.radius_m - 0.5 * circle.width_m;
  const double far = std::sqrt(outer * outer - off * off);
  const double near = std::sqrt(std::max(0.0, inner * inner - off * off));
  if (params.by_one_side) tellEndsAtCircle(edge, middle, far, params);
  for (const Stretch& gap : {Stretch{middle - far, middle - near}, Stretch{middle + near, middle + far}}) {
    if (gap.to > 0.0 && gap.from < edge.length) edge.gaps.push_back(gap);
  }
}

/// What is left of an edge, the longest part first.
std::vector<Stretch> partsOf(Edge& edge, const JunctionParams& params) {
  std::sort(edge.gaps.begin(), edge.gaps.end(),
            [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::vector<Stretch> parts;
  double from = edge.told.from;
  // What goes on behind the last gap by less than an end is known goes on by mistake.
  const auto add = [&](double to, double least) {
    if (to - from >= least) parts.push_back({from, to});
  };
  for (std::size_t i = 0; i < edge.gaps.size(); ++i) {
    add(edge.gaps[i].from, i == 0 ? edge.reach(false, params) : params.min_part_m);
    from = std::max(from, edge.gaps[i].to);
  }
  add(edge.told.to, edge.gaps.empty() ? 0.0 : edge.reach(true, params));
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Stretch& a, const Stretch& b) { return a.to - a.from > b.to - b.from; });
  return parts;
}

}  // namespace

void partAtJunctions(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                     const std::vector<Primitive>& primitives, const LineWidths& widths,
                     const JunctionParams& params,
                     const std::function<std::uint64_t(std::uint64_t, int)>& id_of) {
  if (!params.enabled) return;
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (segments[i].label == kUnknownLabel) continue;
    const auto element = std::find_if(elements.begin(), elements.end(),
                                      [&](const MemoryElement& e) { return e.value.id == segments[i].id; });
    if (!segments[i].confirmed && (!params.by_one_side || element == elements.end() || element->stands)) {
      continue;
    }
    const Segment2 floor = segments[i].odom.floor();
    Edge edge;
    edge.confirmed = segments[i].confirmed;
    edge.segment = i;
    edge.element = element != elements.end() ? &*element : nullptr;
    edge.a = floor.a;
    edge.length = floor.length();
    edge.along = (floor.b - floor.a) / edge.length;
    edge.told = {0.0, edge.length};
    edges.push_back(std::move(edge));
  }
  std::vector<Line> lines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].element || !edges[i].confirmed) continue;
    const auto width = widths.find(segments[edges[i].segment].label);
    bool alone = true;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (k == i || !edges[k].element) continue;
      if (const auto line = lineOf(edges, i, k, segments, params)) {
        lines.push_back(*line);
        alone = false;
      }
    }
    if (params.by_one_side && alone && width != widths.end() && edges[i].length >= params.body_m) {
      lines.push_back({i, std::nullopt, width->second});
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].confirmed) continue;
    const MemorySegment& segment = segments[edges[i].segment];
    for (const Line& line : lines) {
      if (line.one == i || line.other == i) continue;
      if (segments[edges[line.one].segment].label == segment.label) partByLine(edges, i, line, params);
    }
    for (const Primitive& circle : primitives) {
      if (circle.kind != PrimitiveKind::kCircle || circle.width_m <= 0.0) continue;
      if (std::binary_search(circle.segments.begin(), circle.segments.end(), segment.id)) continue;
      partByCircle(edges[i], circle, params);
    }
  }
  std::vector<std::uint64_t> gone;
  for (Edge& edge : edges) {
    if (!edge.confirmed) continue;
    const auto parts = partsOf(edge, params);
    const MemorySegment whole = segments[edge.segment];
    if (parts.empty()) gone.push_back(whole.id);
    for (std::size_t n = 0; n < parts.size(); ++n) {
      MemorySegment part = whole;
      const Eigen::Vector2d a = edge.a + parts[n].from * edge.along;
      const Eigen::Vector2d b = edge.a + parts[n].to * edge.along;
      part.odom.a.head<2>() = a;
      part.odom.b.head<2>() = b;
      if (n > 0) part.id = id_of(whole.id, static_cast<int>(n) - 1);
      if (n == 0) {
        segments[edge.segment] = std::move(part);
      } else {
        segments.push_back(std::move(part));
      }
    }
  }
  std::erase_if(segments, [&](const MemorySegment& s) {
    return std::find(gone.begin(), gone.end(), s.id) != gone.end();
  });
}

}  // namespace vismem
