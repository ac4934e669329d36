#include "active_visual_memory/core/line_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "active_visual_memory/core/floor_edge.h"

namespace vismem {
namespace {

struct Side {
  MemorySegment* told = nullptr;
  Segment2 line;
  Eigen::Vector2d along;  ///< as it was first
  double blur_m = 0.0;    ///< so far from its place the blur of the image may have put it
  bool near = false;      ///< seen from near: it stays where it is
  bool fixed = false;     ///< it was put where it belongs, or stays
  bool paired = false;    ///< with a confirmed one
};

struct Pair {
  std::size_t one = 0;
  std::size_t other = 0;
  SideBySide beside;
  double overlap_m = 0.0;
};

bool isNear(const MemoryElement& element, const LineWidthParams& params) {
  const double best = std::min(element.line.endA().best_m2, element.line.endB().best_m2);
  return best <= params.near_sigma_m * params.near_sigma_m;
}

/// The width that near lines of each label have; < 0 for dark lines.
LineWidths knownWidths(const std::vector<Side>& sides, const std::vector<Pair>& pairs,
                       const LineWidthParams& params) {
  std::map<Label, std::vector<double>> told;
  for (const Pair& pair : pairs) {
    const Side& one = sides[pair.one];
    const Side& other = sides[pair.other];
    if (!one.near || !other.near || !one.told->confirmed || !other.told->confirmed) continue;
    const double width = std::abs(pair.beside.left_m);
    // What is hardly longer than wide is a mark, and no line.
    if (width < params.min_width_m || pair.overlap_m < params.least_length_widths * width) continue;
    told[one.told->label].push_back(pair.beside.left_m);
  }
  LineWidths known;
  for (auto& [label, widths] : told) {
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

/// The segment on the line through a point, as long as it was.
Segment2 laidOn(const Segment2& segment, const Eigen::Vector2d& through, const Eigen::Vector2d& along) {
  const auto at = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(through + along.dot(p - through) * along);
  };
  return {at(segment.a), at(segment.b)};
}

bool isSmallMove(const Segment2& from, const Segment2& to, double most_m) {
  return (from.a - to.a).norm() <= most_m && (from.b - to.b).norm() <= most_m;
}

void tell(Side& side, const Segment2& line) {
  side.line = line;
  side.fixed = true;
  side.told->odom.a.head<2>() = line.a;
  side.told->odom.b.head<2>() = line.b;
}

std::vector<Side> sidesOf(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          const LineWidthParams& params) {
  std::vector<Side> sides;
  for (MemorySegment& segment : segments) {
    if (segment.label == kUnknownLabel) continue;
    const auto element = std::find_if(elements.begin(), elements.end(),
                                      [&](const MemoryElement& e) { return e.value.id == segment.id; });
    if (element == elements.end() || element->stands) continue;
    const bool near = isNear(*element, params);
    const Segment2 line = segment.odom.floor();
    const double blur = std::min(params.max_width_m, params.blur_px * element->pixel_m);
    sides.push_back(
        {&segment, line, (line.b - line.a).normalized(), blur, near, near && segment.confirmed, false});
  }
  return sides;
}

/// Sides that lie beside each other, one of them confirmed.
std::vector<Pair> pairsOf(std::vector<Side>& sides, const LineWidthParams& params) {
  std::vector<Pair> pairs;
  const double least_against = -std::cos(params.max_angle_rad);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (std::size_t k = i + 1; k < sides.size(); ++k) {
      if (sides[i].along.dot(sides[k].along) > least_against) continue;
      if (!sides[i].told->confirmed && !sides[k].told->confirmed) continue;
      if (sides[i].told->label != sides[k].told->label) continue;
      const auto beside = sideBySide(sides[i].line, sides[k].line, params.max_angle_rad);
      const double most = params.max_width_m + sides[i].blur_m + sides[k].blur_m;
      if (!beside || std::abs(beside->left_m) > most) continue;
      const double overlap = beside->to_m - beside->from_m;
      if (overlap < params.min_overlap * std::min(sides[i].line.length(), sides[k].line.length())) continue;
      pairs.push_back({i, k, *beside, overlap});
      const bool both = sides[i].told->confirmed && sides[k].told->confirmed;
      sides[i].paired = sides[i].paired || both;
      sides[k].paired = sides[k].paired || both;
    }
  }
  return pairs;
}

/// Puts both sides of a line `width_m` apart, as far as they may move.
/// @return whether they are.
bool setApart(Side& one, Side& other, const SideBySide& beside, double width_m,
              const LineWidthParams& params) {
  const Eigen::Vector2d along_one = (one.line.b - one.line.a).normalized();
  const Eigen::Vector2d along_other = (other.line.b - other.line.a).normalized();
  const Eigen::Vector2d at_one = one.line.a + 0.5 * (beside.from_m + beside.to_m) * along_one;
  Eigen::Vector2d u = (one.line.length() * along_one - other.line.length() * along_other).normalized();
  if (one.fixed) u = along_one;
  if (other.fixed) u = -along_other;
  const Eigen::Vector2d left{-u.y(), u.x()};
  Eigen::Vector2d base = at_one + 0.5 * (beside.left_m - width_m) * left;
  if (one.fixed) base = at_one;
  if (other.fixed) base = at_one + (beside.left_m - width_m) * left;
  const Segment2 new_one = laidOn(one.line, base, u);
  const Segment2 new_other = laidOn(other.line, base + width_m * left, -u);
  if (!isSmallMove(one.line, new_one, std::max(params.most_shift_m, one.blur_m)) ||
      !isSmallMove(other.line, new_other, std::max(params.most_shift_m, other.blur_m))) {
    return false;
  }
  if (!one.fixed) tell(one, new_one);
  if (!other.fixed) tell(other, new_other);
  return true;
}

}  // namespace

std::optional<SideBySide> sideBySide(const Segment2& one, const Segment2& other, double max_angle_rad) {
  const double length = one.length();
  const Eigen::Vector2d along = (one.b - one.a) / length;
  const Eigen::Vector2d against = (other.b - other.a).normalized();
  if (along.dot(against) > -std::cos(max_angle_rad)) return std::nullopt;
  SideBySide beside;
  beside.from_m = std::max(0.0, along.dot(other.b - one.a));
  beside.to_m = std::min(length, along.dot(other.a - one.a));
  if (beside.to_m <= beside.from_m) return std::nullopt;
  const Eigen::Vector2d at = one.a + 0.5 * (beside.from_m + beside.to_m) * along;
  beside.left_m = cross(against, at - other.a);
  return beside;
}

LineWidths nearLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          const LineWidthParams& params) {
  if (!params.enabled) return {};
  std::vector<Side> sides = sidesOf(segments, elements, params);
  return knownWidths(sides, pairsOf(sides, params), params);
}

LineWidths evenLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          const LineWidthParams& params) {
  if (!params.enabled) return {};
  std::vector<Side> sides = sidesOf(segments, elements, params);
  std::vector<Pair> pairs = pairsOf(sides, params);
  LineWidths widths = knownWidths(sides, pairs, params);
  // No line is so thin, from however near: its sides were found in one place when the image was too coarse.
  for (const Pair& pair : pairs) {
    Side& one = sides[pair.one];
    Side& other = sides[pair.other];
    if (std::abs(pair.beside.left_m) < params.min_width_m) one.fixed = other.fixed = false;
  }
  // The longest first; what is put in its place by one line stays there for the others.
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap_m > b.overlap_m; });
  for (const Pair& pair : pairs) {
    Side& one = sides[pair.one];
    Side& other = sides[pair.other];
    const auto width = widths.find(one.told->label);
    if (width == widths.end() || (one.fixed && other.fixed)) continue;
    const auto beside = sideBySide(one.line, other.line, params.max_angle_rad);
    if (!beside) continue;
    const bool both = one.told->confirmed && other.told->confirmed;
    if (!both) {
      Side& known = one.told->confirmed ? one : other;
      Side& partner = one.told->confirmed ? other : one;
      const double length = partner.line.length();
      if (known.paired || length < params.partner_least_m ||
          pair.overlap_m < params.partner_overlap * length) {
        continue;
      }
      // Their middle is told best by both.
      if (!setApart(one, other, *beside, width->second, params)) continue;
      partner.told->confirmed = true;
      known.paired = partner.paired = true;
      continue;
    }
    setApart(one, other, *beside, width->second, params);
  }
  return widths;
}

}  // namespace vismem
