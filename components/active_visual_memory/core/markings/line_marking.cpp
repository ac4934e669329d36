#include "active_visual_memory/core/markings/line_marking.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

struct PublishedEdge {
  MemorySegment* published = nullptr;
  Segment2 line;
  Eigen::Vector2d along;  ///< before any move
  double blur_m = 0.0;    ///< displacement by blur, at most [m]
  bool near = false;      ///< near: it is not moved
  bool fixed = false;     ///< moved already, or near
  bool paired = false;    ///< paired with a confirmed edge
};

struct Pair {
  std::size_t one = 0;
  std::size_t other = 0;
  AntiparallelOverlap beside;
  double overlap_m = 0.0;
};

bool isNear(const MemoryElement& element, const LineWidthParams& params) {
  const double best = std::min(element.line.endA().best_m2, element.line.endB().best_m2);
  return best <= params.near_sigma_m * params.near_sigma_m;
}

/// Signed width of near lines by label.
LineWidths knownWidths(const std::vector<PublishedEdge>& edges, const std::vector<Pair>& pairs,
                       const LineWidthParams& params) {
  std::map<Label, std::vector<double>> published;
  for (const Pair& pair : pairs) {
    const PublishedEdge& one = edges[pair.one];
    const PublishedEdge& other = edges[pair.other];
    if (!one.near || !other.near || !one.published->confirmed || !other.published->confirmed) continue;
    const double width = std::abs(pair.beside.left_m);
    // Short pairs are spots, not lines.
    if (width < params.range.minMeasured_m() || pair.overlap_m < params.least_length_widths * width) continue;
    published[one.published->label].push_back(pair.beside.left_m);
  }
  LineWidths known;
  for (auto& [label, widths] : published) {
    std::sort(widths.begin(), widths.end());
    const double median = widths[widths.size() / 2];
    const auto agreeing = std::count_if(widths.begin(), widths.end(), [&](double width) {
      return std::abs(width - median) <= params.agree_m;
    });
    if (static_cast<double>(agreeing) >= params.agree_share * static_cast<double>(widths.size())) {
      known[label] = median;
    }
  }
  return known;
}

/// Projects a segment onto the line through a point, keeping its length.
Segment2 laidOn(const Segment2& segment, const Eigen::Vector2d& through, const Eigen::Vector2d& along) {
  const auto at = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(through + along.dot(p - through) * along);
  };
  return {at(segment.a), at(segment.b)};
}

bool isSmallMove(const Segment2& from, const Segment2& to, double most_m) {
  return (from.a - to.a).norm() <= most_m && (from.b - to.b).norm() <= most_m;
}

void publishAt(PublishedEdge& edge, const Segment2& line) {
  edge.line = line;
  edge.fixed = true;
  edge.published->odom.a.head<2>() = line.a;
  edge.published->odom.b.head<2>() = line.b;
}

std::vector<PublishedEdge> markingEdges(std::vector<MemorySegment>& segments,
                                        std::span<const MemoryElement> elements,
                                        const LineWidthParams& params) {
  std::vector<PublishedEdge> edges;
  for (MemorySegment& segment : segments) {
    if (segment.label == kUnknownLabel) continue;
    const MemoryElement* element = findElement(elements, segment.id);
    if (!element || element->stands) continue;
    const bool near = isNear(*element, params);
    const Segment2 line = segment.odom.floor();
    const double blur = std::min(params.range.max_m, params.blur_px * element->pixel_m);
    edges.push_back(
        {&segment, line, (line.b - line.a).normalized(), blur, near, near && segment.confirmed, false});
  }
  return edges;
}

/// Pairs of antiparallel edges, at least one of them confirmed.
std::vector<Pair> pairsOf(std::vector<PublishedEdge>& edges, const LineWidthParams& params) {
  std::vector<Pair> pairs;
  const double least_against = -std::cos(params.max_angle_rad);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = i + 1; k < edges.size(); ++k) {
      if (edges[i].along.dot(edges[k].along) > least_against) continue;
      if (!edges[i].published->confirmed && !edges[k].published->confirmed) continue;
      if (edges[i].published->label != edges[k].published->label) continue;
      const auto beside = antiparallelOverlap(edges[i].line, edges[k].line, params.max_angle_rad);
      const double most = params.range.max_m + edges[i].blur_m + edges[k].blur_m;
      if (!beside || std::abs(beside->left_m) > most) continue;
      const double overlap = beside->to_m - beside->from_m;
      if (overlap < params.min_overlap * std::min(edges[i].line.length(), edges[k].line.length())) continue;
      pairs.push_back({i, k, *beside, overlap});
      const bool both = edges[i].published->confirmed && edges[k].published->confirmed;
      edges[i].paired = edges[i].paired || both;
      edges[k].paired = edges[k].paired || both;
    }
  }
  return pairs;
}

/// Moves both edges of a line `width_m` apart, within their limits.
/// @return false if an end would move too far.
bool setApart(PublishedEdge& one, PublishedEdge& other, const AntiparallelOverlap& beside, double width_m,
              const LineWidthParams& params) {
  const Eigen::Vector2d along_one = (one.line.b - one.line.a).normalized();
  const Eigen::Vector2d along_other = (other.line.b - other.line.a).normalized();
  const Eigen::Vector2d at_one = one.line.a + 0.5 * (beside.from_m + beside.to_m) * along_one;
  Eigen::Vector2d u = (one.line.length() * along_one - other.line.length() * along_other).normalized();
  if (one.fixed) u = along_one;
  if (other.fixed) u = -along_other;
  const Eigen::Vector2d left = turned90(u);
  Eigen::Vector2d base = at_one + 0.5 * (beside.left_m - width_m) * left;
  if (one.fixed) base = at_one;
  if (other.fixed) base = at_one + (beside.left_m - width_m) * left;
  const Segment2 new_one = laidOn(one.line, base, u);
  const Segment2 new_other = laidOn(other.line, base + width_m * left, -u);
  if (!isSmallMove(one.line, new_one, std::max(params.most_shift_m, one.blur_m)) ||
      !isSmallMove(other.line, new_other, std::max(params.most_shift_m, other.blur_m))) {
    return false;
  }
  if (!one.fixed) publishAt(one, new_one);
  if (!other.fixed) publishAt(other, new_other);
  return true;
}

}  // namespace

std::optional<AntiparallelOverlap> antiparallelOverlap(const Segment2& one, const Segment2& other,
                                                       double max_angle_rad) {
  const double length = one.length();
  const Eigen::Vector2d along = (one.b - one.a) / length;
  const Eigen::Vector2d against = (other.b - other.a).normalized();
  if (along.dot(against) > -std::cos(max_angle_rad)) return std::nullopt;
  AntiparallelOverlap beside;
  beside.from_m = std::max(0.0, along.dot(other.b - one.a));
  beside.to_m = std::min(length, along.dot(other.a - one.a));
  if (beside.to_m <= beside.from_m) return std::nullopt;
  const Eigen::Vector2d at = one.a + 0.5 * (beside.from_m + beside.to_m) * along;
  beside.left_m = cross2(against, at - other.a);
  return beside;
}

LineWidths measureLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                             const LineWidthParams& params) {
  if (!params.enabled) return {};
  std::vector<PublishedEdge> edges = markingEdges(segments, elements, params);
  return knownWidths(edges, pairsOf(edges, params), params);
}

LineWidths equalizeLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                              const LineWidthParams& params) {
  if (!params.enabled) return {};
  std::vector<PublishedEdge> edges = markingEdges(segments, elements, params);
  std::vector<Pair> pairs = pairsOf(edges, params);
  LineWidths widths = knownWidths(edges, pairs, params);
  // Closer edges than any line has were measured in one place by a coarse image, however near.
  for (const Pair& pair : pairs) {
    PublishedEdge& one = edges[pair.one];
    PublishedEdge& other = edges[pair.other];
    if (std::abs(pair.beside.left_m) < params.range.minMeasured_m()) one.fixed = other.fixed = false;
  }
  // The longest first; an edge moved by one pair stays for the others.
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap_m > b.overlap_m; });
  for (const Pair& pair : pairs) {
    PublishedEdge& one = edges[pair.one];
    PublishedEdge& other = edges[pair.other];
    const auto width = widths.find(one.published->label);
    if (width == widths.end() || (one.fixed && other.fixed)) continue;
    const auto beside = antiparallelOverlap(one.line, other.line, params.max_angle_rad);
    if (!beside) continue;
    const bool both = one.published->confirmed && other.published->confirmed;
    if (!both) {
      PublishedEdge& known = one.published->confirmed ? one : other;
      PublishedEdge& partner = one.published->confirmed ? other : one;
      const double length = partner.line.length();
      if (known.paired || length < params.partner_least_m ||
          pair.overlap_m < params.partner_overlap * length) {
        continue;
      }
      // The middle of both is the best estimate.
      if (!setApart(one, other, *beside, width->second, params)) continue;
      partner.published->confirmed = true;
      known.paired = partner.paired = true;
      continue;
    }
    setApart(one, other, *beside, width->second, params);
  }
  return widths;
}

}  // namespace vismem
