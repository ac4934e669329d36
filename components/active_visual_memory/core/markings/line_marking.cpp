#include "active_visual_memory/core/markings/line_marking.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// An edge that may take part in a line marking.
struct MarkingEdge : PublishedEdge {
  double blur_m = 0.0;  ///< displacement by blur, at most [m]
  bool fixed = false;   ///< near, or moved already
  bool paired = false;  ///< with a confirmed edge
};

struct Pair {
  std::size_t one = 0;
  std::size_t other = 0;
  Neighbourhood beside;
};

bool mayBePaint(const PublishedEdge& edge) {
  return edge.element && !edge.element->plane.stands && edge.published->label != kUnknownLabel;
}

bool isNear(const PublishedEdge& edge, const LineWidthParams& params) {
  const FloorLine& line = edge.element->line;
  return edge.confirmed() &&
         std::min(line.endA().best_m2, line.endB().best_m2) <= params.near_sigma_m * params.near_sigma_m;
}

/// Projects a segment onto the line through a point, keeping its length.
Segment2 laidOn(const Segment2& segment, const Eigen::Vector2d& through, const Eigen::Vector2d& along) {
  const auto at = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(through + along.dot(p - through) * along);
  };
  return {at(segment.a), at(segment.b)};
}

/// Pairs of edges, at least one of them confirmed; the longest overlap first.
std::pmr::vector<Pair> pairsOf(std::pmr::vector<MarkingEdge>& edges, const LineWidthParams& params) {
  std::pmr::vector<Pair> pairs(edges.get_allocator());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = i + 1; k < edges.size(); ++k) {
      MarkingEdge& one = edges[i];
      MarkingEdge& other = edges[k];
      if (!one.confirmed() && !other.confirmed()) continue;
      const auto beside = lineMarking(one, other, params.range.max_m + one.blur_m + other.blur_m);
      if (!beside || beside->overlap_m() < params.min_overlap * std::min(one.length(), other.length()))
        continue;
      pairs.push_back({i, k, *beside});
      const bool both = one.confirmed() && other.confirmed();
      one.paired = one.paired || both;
      other.paired = other.paired || both;
      // Closer edges than any line has were measured in one place by a coarse image, however near.
      if (beside->distance_m < params.range.minMeasured_m()) one.fixed = other.fixed = false;
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tuple(-a.beside.overlap_m(), a.one, a.other) <
           std::tuple(-b.beside.overlap_m(), b.one, b.other);
  });
  return pairs;
}

/// Moves both edges of a line `width_m` apart, within their limits.
/// @return false if an end would move too far.
bool setApart(MarkingEdge& one, MarkingEdge& other, const Neighbourhood& beside, double width_m,
              const LineWidthParams& params) {
  const Eigen::Vector2d along_one = (one.line.b - one.line.a).normalized();
  const Eigen::Vector2d along_other = (other.line.b - other.line.a).normalized();
  const Eigen::Vector2d at_one = one.line.a + beside.middle_m() * along_one;
  Eigen::Vector2d u = (one.line.length() * along_one - other.line.length() * along_other).normalized();
  if (one.fixed) u = along_one;
  if (other.fixed) u = -along_other;
  const double share = one.fixed ? 0.0 : other.fixed ? 1.0 : 0.5;
  const Eigen::Vector2d base = at_one + share * (beside.left_m - width_m) * turned90(u);
  const Segment2 new_one = laidOn(one.line, base, u);
  const Segment2 new_other = laidOn(other.line, base + width_m * turned90(u), -u);
  const auto isSmallMove = [&](const MarkingEdge& edge, const Segment2& to) {
    const double most = std::max(params.most_shift_m, edge.blur_m);
    return (edge.line.a - to.a).norm() <= most && (edge.line.b - to.b).norm() <= most;
  };
  if (!isSmallMove(one, new_one) || !isSmallMove(other, new_other)) return false;
  if (!one.fixed) one.line = new_one;
  if (!other.fixed) other.line = new_other;
  for (MarkingEdge* edge : {&one, &other}) {
    if (!edge->fixed) placeAt(*edge->published, edge->line);
    edge->fixed = true;
  }
  return true;
}

}  // namespace

std::optional<Neighbourhood> lineMarking(const PublishedEdge& one, const PublishedEdge& other,
                                         double max_width_m, double min_strength_share) {
  if (one.published->label != other.published->label) return std::nullopt;
  const auto [weak, strong] = std::minmax(one.element->strength, other.element->strength);
  if (weak < min_strength_share * strong) return std::nullopt;
  const auto beside = antiparallel(one.line, other.line);
  return beside && beside->distance_m <= max_width_m ? beside : std::nullopt;
}

LineWidths measureLineWidths(std::span<const PublishedEdge> edges, const LineWidthParams& params,
                             std::pmr::memory_resource* scratch) {
  LineWidths known(scratch);
  if (!params.enabled) return known;
  std::pmr::vector<PublishedEdge> near(scratch);
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(near),
               [&](const PublishedEdge& edge) { return mayBePaint(edge) && isNear(edge, params); });
  std::pmr::map<Label, std::pmr::vector<double>> measured(scratch);
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (std::size_t k = i + 1; k < near.size(); ++k) {
      const auto beside = lineMarking(near[i], near[k], params.range.max_m);
      // Short pairs are spots, not lines.
      if (!beside || beside->distance_m < params.range.minMeasured_m() ||
          beside->overlap_m() < params.min_overlap * std::min(near[i].length(), near[k].length()) ||
          beside->overlap_m() < params.least_length_widths * beside->distance_m) {
        continue;
      }
      measured[near[i].published->label].push_back(beside->left_m);
    }
  }
  for (auto& [label, widths] : measured) {
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

void equalizeLineWidths(std::span<const PublishedEdge> edges, const LineWidths& widths,
                        const LineWidthParams& params, std::pmr::memory_resource* scratch) {
  std::pmr::vector<MarkingEdge> sides(scratch);
  for (const PublishedEdge& edge : edges) {
    if (!mayBePaint(edge) || !widths.contains(edge.published->label)) continue;
    const double blur = std::min(params.range.max_m, params.blur_px * edge.element->pixel_m);
    sides.push_back({edge, blur, isNear(edge, params), false});
  }
  for (const Pair& pair : pairsOf(sides, params)) {
    MarkingEdge& one = sides[pair.one];
    MarkingEdge& other = sides[pair.other];
    // An edge moved by one pair stays for the others.
    const auto beside = antiparallel(one.line, other.line);
    if (!beside || (one.fixed && other.fixed)) continue;
    const bool both = one.confirmed() && other.confirmed();
    MarkingEdge& known = one.confirmed() ? one : other;
    MarkingEdge& partner = one.confirmed() ? other : one;
    const double length = partner.line.length();
    if (!both && (known.paired || length < params.partner_least_m ||
                  pair.beside.overlap_m() < params.partner_overlap * length)) {
      continue;
    }
    // The middle of both is the best estimate.
    if (!setApart(one, other, *beside, widths.at(one.published->label), params) || both) continue;
    partner.published->confirmed = true;
    known.paired = partner.paired = true;
  }
}

}  // namespace vismem
