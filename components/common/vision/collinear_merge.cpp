#include "common/vision/collinear_merge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace vismem {
namespace {

constexpr double kCell_px = 16.0;

/// A segment as a rod: mass (length), middle and second moments survive any number of joins, so the line of
/// a joined one is the least-squares line of all its original parts.
struct Rod {
  Segment2 px;
  int group = 0;
  double mass = 0.0;
  double value = 0.0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double xx = 0.0;  // central second moments, times mass
  double xy = 0.0;
  double yy = 0.0;
};

auto key(const Segment2& px) {
  return std::make_tuple(px.a.x(), px.a.y(), px.b.x(), px.b.y());
}

Rod makeRod(const GroupedSegment& segment) {
  Rod rod;
  rod.px = segment.px;
  rod.group = segment.group;
  const Eigen::Vector2d d = segment.px.b - segment.px.a;
  const double length = d.norm();
  rod.mass = length * segment.weight;
  rod.value = segment.value;
  rod.middle = segment.px.middle();
  rod.direction = d / length;
  rod.xx = rod.mass * d.x() * d.x() / 12.0;
  rod.xy = rod.mass * d.x() * d.y() / 12.0;
  rod.yy = rod.mass * d.y() * d.y() / 12.0;
  return rod;
}

Rod join(const Rod& a, const Rod& b) {
  Rod rod;
  rod.group = a.group;
  rod.mass = a.mass + b.mass;
  const double wa = a.mass / rod.mass;
  const double wb = b.mass / rod.mass;
  rod.value = wa * a.value + wb * b.value;
  rod.middle = wa * a.middle + wb * b.middle;
  const Eigen::Vector2d apart = b.middle - a.middle;
  const double reduced = wa * b.mass;
  rod.xx = a.xx + b.xx + reduced * apart.x() * apart.x();
  rod.xy = a.xy + b.xy + reduced * apart.x() * apart.y();
  rod.yy = a.yy + b.yy + reduced * apart.y() * apart.y();
  const double angle = 0.5 * std::atan2(2.0 * rod.xy, rod.xx - rod.yy);
  rod.direction = {std::cos(angle), std::sin(angle)};
  if (rod.direction.dot(a.mass >= b.mass ? a.direction : b.direction) < 0.0) rod.direction = -rod.direction;
  double low = 0.0;
  double high = 0.0;
  for (const Eigen::Vector2d* end : {&a.px.a, &a.px.b, &b.px.a, &b.px.b}) {
    const double t = (*end - rod.middle).dot(rod.direction);
    low = std::min(low, t);
    high = std::max(high, t);
  }
  rod.px = {rod.middle + low * rod.direction, rod.middle + high * rod.direction};
  return rod;
}

struct Candidate {
  double gap = 0.0;
  double offset = 0.0;
  int a = 0;  // < b
  int b = 0;
};

/// Gap and offset of a pair, negative gap if they cannot be joined.
Candidate judge(const std::vector<Rod>& rods, int a, int b, const CollinearMergeParams& params,
                double cos_limit) {
  Candidate none{-1.0, 0.0, a, b};
  const Rod& first = rods[a];
  const Rod& second = rods[b];
  if (first.group != second.group || first.direction.dot(second.direction) < cos_limit) return none;
  const bool first_longer = first.px.length() >= second.px.length();
  const Rod& longer = first_longer ? first : second;
  const Rod& shorter = first_longer ? second : first;
  const Eigen::Vector2d normal(-longer.direction.y(), longer.direction.x());
  const double offset = std::max(std::abs((shorter.px.a - longer.middle).dot(normal)),
                                 std::abs((shorter.px.b - longer.middle).dot(normal)));
  if (offset > params.offset_px) return none;
  const double begin = (shorter.px.a - longer.px.a).dot(longer.direction);
  const double end = (shorter.px.b - longer.px.a).dot(longer.direction);
  const double gap = std::max({0.0, begin - longer.px.length(), -end});
  if (gap > params.gap_px) return none;
  return {gap, offset, a, b};
}

/// Segments by the cells they touch: sorted (cell, segment) pairs.
class Grid {
 public:
  Grid(const std::vector<Rod>& rods, double reach_px) : cell_(std::max(kCell_px, reach_px)) {
    for (std::size_t i = 0; i < rods.size(); ++i) {
      const Segment2& px = rods[i].px;
      const int steps = static_cast<int>(std::ceil(px.length() / (0.5 * cell_)));
      std::uint64_t last = 0;
      for (int s = 0; s <= steps; ++s) {
        const Eigen::Vector2d p = px.a + (px.b - px.a) * (static_cast<double>(s) / std::max(steps, 1));
        const std::uint64_t cell = cellOf(coordinate(p.x()), coordinate(p.y()));
        if (s > 0 && cell == last) continue;
        last = cell;
        entries_.emplace_back(cell, static_cast<int>(i));
      }
    }
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls visit(index) for every segment with a point near p (some more than once).
  template <typename Visit>
  void around(const Eigen::Vector2d& p, Visit visit) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::uint64_t cell = cellOf(coordinate(p.x()) + dx, coordinate(p.y()) + dy);
        auto entry = std::lower_bound(entries_.begin(), entries_.end(), std::make_pair(cell, -1));
        for (; entry != entries_.end() && entry->first == cell; ++entry) visit(entry->second);
      }
    }
  }

 private:
  int coordinate(double value) const { return static_cast<int>(std::floor(value / cell_)); }
  static std::uint64_t cellOf(int x, int y) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 | static_cast<std::uint32_t>(x);
  }

  double cell_;
  std::vector<std::pair<std::uint64_t, int>> entries_;
};

std::vector<Candidate> candidates(const std::vector<Rod>& rods, const CollinearMergeParams& params) {
  const double cos_limit = std::cos(params.angle_rad);
  // Samples of a body lie half a cell apart: with this reach no near end is missed.
  const Grid grid(rods, 1.5 * (params.gap_px + params.offset_px));
  std::vector<Candidate> found;
  for (int i = 0; i < static_cast<int>(rods.size()); ++i) {
    for (const Eigen::Vector2d* end : {&rods[i].px.a, &rods[i].px.b}) {
      grid.around(*end, [&](int other) {
        if (other == i) return;
        const Candidate candidate = judge(rods, std::min(i, other), std::max(i, other), params, cos_limit);
        if (candidate.gap >= 0.0) found.push_back(candidate);
      });
    }
  }
  std::sort(found.begin(), found.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.gap, x.offset, x.a, x.b) < std::tie(y.gap, y.offset, y.a, y.b);
  });
  return found;
}

}  // namespace

std::vector<GroupedSegment> mergeCollinear(std::vector<GroupedSegment> segments,
                                           const CollinearMergeParams& params) {
  std::erase_if(segments, [](const GroupedSegment& segment) { return !(segment.px.length() > 0.0); });
  std::vector<Rod> rods;
  rods.reserve(segments.size());
  for (const auto& segment : segments) rods.push_back(makeRod(segment));
  const auto canonical = [](const Rod& a, const Rod& b) {
    return std::make_tuple(key(a.px), a.group, a.value, a.mass) <
           std::make_tuple(key(b.px), b.group, b.value, b.mass);
  };
  std::sort(rods.begin(), rods.end(), canonical);
  while (true) {
    std::vector<bool> taken(rods.size(), false);
    std::vector<Rod> joined;
    for (const Candidate& pair : candidates(rods, params)) {
      if (taken[pair.a] || taken[pair.b]) continue;
      taken[pair.a] = taken[pair.b] = true;
      joined.push_back(join(rods[pair.a], rods[pair.b]));
    }
    if (joined.empty()) break;
    for (std::size_t i = 0; i < rods.size(); ++i) {
      if (!taken[i]) joined.push_back(rods[i]);
    }
    rods = std::move(joined);
    std::sort(rods.begin(), rods.end(), canonical);
  }
  std::vector<GroupedSegment> merged;
  merged.reserve(rods.size());
  for (const Rod& rod : rods) merged.push_back({rod.px, rod.group, rod.mass / rod.px.length(), rod.value});
  return merged;
}

}  // namespace vismem
