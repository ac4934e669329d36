#include "active_visual_memory/core/markings/junctions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "active_visual_memory/core/markings/line_marking.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// An interval along an edge, from its end a [m].
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

struct Edge : PublishedEdge {
  Stretch extent;  ///< its ends, corrected by junctions
  std::pmr::vector<Stretch> gaps;

  Edge(const PublishedEdge& edge, std::pmr::memory_resource* scratch)
      : PublishedEdge(edge), extent{0.0, edge.length()}, gaps(scratch) {}
  /// Position along this edge where another edge's line crosses it.
  double crossing(const Edge& other) const {
    return cross2(other.line.a - line.a, other.along) / cross2(along, other.along);
  }
  double reach(bool at_b, const JunctionParams& params) const {
    return params.reach.of(element ? element->line.end(at_b) : ExtentEnd{});
  }
};

/// A line marking, by a confirmed edge of it.
struct Line {
  std::size_t one = 0;
  std::optional<std::size_t> other;
  double width_m = 0.0;  ///< > 0: the paint lies to the left of each edge; < 0: to the right
};

std::pmr::vector<Line> linesOf(const std::pmr::vector<Edge>& edges, const LineWidths& widths,
                               const JunctionParams& params) {
  std::pmr::vector<Line> lines(edges.get_allocator());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].element || !edges[i].confirmed()) continue;
    bool alone = true;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (k == i || !edges[k].element) continue;
      const auto beside = lineMarking(edges[i], edges[k], params.range.max_m, params.min_strength_share);
      if (!beside || beside->overlap_m() < params.body_m ||
          beside->distance_m < params.range.minMeasured_m()) {
        continue;
      }
      lines.push_back({i, k, beside->left_m});
      alone = false;
    }
    const auto width = widths.find(edges[i].published->label);
    if (params.by_one_side && alone && width != widths.end() && edges[i].length() >= params.body_m) {
      lines.push_back({i, std::nullopt, width->second});
    }
  }
  return lines;
}

/// Where an edge of a line reaches another edge.
struct EdgeCrossing {
  double at = 0.0;    ///< along the edge
  bool ends = false;  ///< the edge of the line ends here ..
  bool at_b = false;  ///< .. with its end b; else it continues across
  double side_t = 0.0;
};

/// @param outward  direction away from the paint of the edge.
std::optional<EdgeCrossing> crossEdge(const Edge& edge, const Edge& side, const Eigen::Vector2d& outward,
                                      const JunctionParams& params) {
  if (std::abs(cross2(edge.along, side.along)) < std::sin(params.min_crossing_rad)) return std::nullopt;
  EdgeCrossing crossing_at;
  crossing_at.at = edge.crossing(side);
  crossing_at.side_t = side.crossing(edge);
  const bool leads_outward = side.along.dot(outward) > 0.0;
  const double outside = leads_outward ? side.length() - crossing_at.side_t : crossing_at.side_t;
  const double inside = leads_outward ? crossing_at.side_t : side.length() - crossing_at.side_t;
  crossing_at.at_b = !leads_outward;
  const double reach = side.reach(crossing_at.at_b, params);
  if (outside < params.body_m || inside < -reach) return std::nullopt;
  crossing_at.ends = inside <= reach;
  return crossing_at;
}

void splitByLine(std::span<Edge> edges, std::size_t index, const Line& line, const JunctionParams& params) {
  Edge& edge = edges[index];
  const Eigen::Vector2d outward = -std::copysign(1.0, line.width_m) * turned90(edge.along);
  Edge& side = edges[line.one];
  const auto one = crossEdge(edge, side, outward, params);
  if (!one) return;
  const auto other = line.other ? crossEdge(edge, edges[*line.other], outward, params) : std::nullopt;
  if (!other && !params.by_one_side) return;
  // The unobserved edge of the line lies at its width.
  const double across = cross2(side.along, edge.along);
  const double beside = other ? other->at : one->at + line.width_m / across;
  const Stretch gap{std::min(one->at, beside), std::max(one->at, beside)};
  // Where the middle lies beyond its end, both lines meet at a corner, and the outer edges go on to it.
  const double middle = 0.5 * (gap.from + gap.to);
  if (gap.to - gap.from > 2.0 * params.range.max_m || middle <= 0.0 || middle >= edge.length()) return;
  edge.gaps.push_back(gap);
  if (one->ends) (one->at_b ? side.extent.to : side.extent.from) = one->side_t;
}

/// @param middle  of the circle, along the edge. @param far distance of its outer edge from there.
void moveEndsToCircle(Edge& edge, double middle, double far, const JunctionParams& params) {
  const double before = edge.extent.from - (middle + far);
  if (before > 0.0 && before <= edge.reach(false, params)) edge.extent.from = middle + far;
  const double behind = middle - far - edge.extent.to;
  if (behind > 0.0 && behind <= edge.reach(true, params)) edge.extent.to = middle - far;
}

void splitByCircle(Edge& edge, const Primitive& circle, const JunctionParams& params) {
  const double off = std::abs(cross2(edge.along, circle.centre - edge.line.a));
  if (off > params.max_off_centre_share * circle.radius_m) return;
  const double middle = edge.along.dot(circle.centre - edge.line.a);
  const double outer = circle.radius_m + 0.5 * circle.width_m;
  const double inner = circle.radius_m - 0.5 * circle.width_m;
  const double far = std::sqrt(outer * outer - off * off);
  const double near = std::sqrt(std::max(0.0, inner * inner - off * off));
  if (params.by_one_side) moveEndsToCircle(edge, middle, far, params);
  for (const Stretch& gap : {Stretch{middle - far, middle - near}, Stretch{middle + near, middle + far}}) {
    if (gap.to > 0.0 && gap.from < edge.length()) edge.gaps.push_back(gap);
  }
}

/// The remaining parts of an edge, the longest first.
std::pmr::vector<Stretch> remainingParts(Edge& edge, const JunctionParams& params) {
  std::sort(edge.gaps.begin(), edge.gaps.end(),
            [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::pmr::vector<Stretch> parts(edge.gaps.get_allocator());
  double from = edge.extent.from;
  // A part shorter than the uncertainty of its end is an overshoot.
  const auto add = [&](double to, double least) {
    if (to - from >= least) parts.push_back({from, to});
  };
  for (std::size_t i = 0; i < edge.gaps.size(); ++i) {
    add(edge.gaps[i].from, i == 0 ? edge.reach(false, params) : params.min_part_m);
    from = std::max(from, edge.gaps[i].to);
  }
  add(edge.extent.to, edge.gaps.empty() ? 0.0 : edge.reach(true, params));
  std::sort(parts.begin(), parts.end(), [](const Stretch& a, const Stretch& b) {
    return std::pair(b.to - b.from, a.from) < std::pair(a.to - a.from, b.from);
  });
  return parts;
}

}  // namespace

void splitAtJunctions(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> published,
                      std::span<const Primitive> primitives, const LineWidths& widths,
                      const JunctionParams& params,
                      const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                      std::pmr::memory_resource* scratch) {
  std::pmr::vector<Edge> edges(scratch);
  for (const PublishedEdge& edge : published) {
    const bool may_join = params.by_one_side && edge.element && !edge.element->plane.stands;
    if (edge.published->label != kUnknownLabel && (edge.confirmed() || may_join))
      edges.emplace_back(edge, scratch);
  }
  const std::pmr::vector<Line> lines = linesOf(edges, widths, params);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].confirmed()) continue;
    const MemorySegment& segment = *edges[i].published;
    for (const Line& line : lines) {
      if (line.one == i || line.other == i) continue;
      if (edges[line.one].published->label == segment.label) splitByLine(edges, i, line, params);
    }
    for (const Primitive& circle : primitives) {
      if (circle.kind != PrimitiveKind::kCircle || circle.width_m <= 0.0) continue;
      if (std::binary_search(circle.segments.begin(), circle.segments.end(), segment.id)) continue;
      splitByCircle(edges[i], circle, params);
    }
  }
  std::pmr::vector<std::uint64_t> gone(scratch);
  std::pmr::vector<MemorySegment> further(scratch);
  for (Edge& edge : edges) {
    if (!edge.confirmed()) continue;
    const auto parts = remainingParts(edge, params);
    if (parts.empty()) gone.push_back(edge.published->id);
    for (std::size_t n = 0; n < parts.size(); ++n) {
      MemorySegment& part = n == 0 ? *edge.published : further.emplace_back(*edge.published);
      if (n > 0) part.id = id_of(edge.published->id, static_cast<int>(n) - 1);
      placeAt(part, {edge.line.a + parts[n].from * edge.along, edge.line.a + parts[n].to * edge.along});
    }
  }
  segments.insert(segments.end(), further.begin(), further.end());
  eraseSegments(segments, gone);
}

}  // namespace vismem
