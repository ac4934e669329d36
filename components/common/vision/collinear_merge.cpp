#include "common/vision/collinear_merge.h"

#include <algorithm>
#include <cmath>
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
  bool fresh = true;  // not yet compared with the others
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

/// Rods by the cells of a dense grid that their bodies touch.
class Grid {
 public:
  Grid(const std::vector<Rod>& rods, double reach_px) : cell_(std::max(kCell_px, reach_px)) {
    low_ = high_ = rods.front().px.a;
    for (const Rod& rod : rods) {
      low_ = low_.cwiseMin(rod.px.a).cwiseMin(rod.px.b);
      high_ = high_.cwiseMax(rod.px.a).cwiseMax(rod.px.b);
    }
    // Far-off ends (a lens undistorted beyond its border) must not make the grid huge.
    cell_ = std::max(cell_, (high_ - low_).maxCoeff() / kMaximumCells);
    columns_ = static_cast<int>((high_.x() - low_.x()) / cell_) + 1;
    rows_ = static_cast<int>((high_.y() - low_.y()) / cell_) + 1;
    begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const Rod& rod : rods) forCells(rod, [this](int cell) { ++begin_[cell + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(begin_.back());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < rods.size(); ++i) {
      forCells(rods[i], [&](int cell) { entries_[next[cell]++] = static_cast<int>(i); });
    }
  }

  /// Calls visit(index) for every rod whose body comes near that of `rod`, some more than once.
  template <typename Visit>
  void around(const Rod& rod, Visit visit) const {
    forCells(rod, [&](int cell) {
      const int x = cell % columns_;
      const int y = cell / columns_;
      for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, rows_ - 1); ++ny) {
        const int row = ny * columns_;
        const int end = begin_[row + std::min(x + 1, columns_ - 1) + 1];
        for (int k = begin_[row + std::max(x - 1, 0)]; k < end; ++k) visit(entries_[k]);
      }
    });
  }

 private:
  static constexpr double kMaximumCells = 512.0;  // along an axis

  /// The cells at points half a cell apart along the body.
  template <typename Visit>
  void forCells(const Rod& rod, Visit visit) const {
    const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * rod.px.length() / cell_)));
    const Eigen::Vector2d step = (rod.px.b - rod.px.a) / (steps * cell_);
    Eigen::Vector2d p = (rod.px.a - low_) / cell_;
    int last = -1;
    for (int s = 0; s <= steps; ++s, p += step) {
      const int x = std::clamp(static_cast<int>(p.x()), 0, columns_ - 1);
      const int y = std::clamp(static_cast<int>(p.y()), 0, rows_ - 1);
      const int cell = y * columns_ + x;
      if (cell != last) visit(cell);
      last = cell;
    }
  }

  double cell_;
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<int> begin_;
  std::vector<int> entries_;
};

/// All pairs that can be joined and have at least one `fresh` rod, closest first.
std::vector<Candidate> candidates(const std::vector<Rod>& rods, const CollinearMergeParams& params) {
  if (rods.empty()) return {};
  const double cos_limit = std::cos(params.angle_rad);
  // Points of a body lie half a cell apart: with this reach no near pair is missed.
  const Grid grid(rods, 2.0 * (params.gap_px + params.offset_px));
  std::vector<Candidate> found;
  for (int i = 0; i < static_cast<int>(rods.size()); ++i) {
    if (!rods[i].fresh) continue;
    grid.around(rods[i], [&](int other) {
      if (other == i || (other < i && rods[other].fresh)) return;
      const Candidate candidate = judge(rods, std::min(i, other), std::max(i, other), params, cos_limit);
      if (candidate.gap >= 0.0) found.push_back(candidate);
    });
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
      if (taken[i]) continue;
      // Two that were both left over cannot be joined with each other, or this pass would have.
      rods[i].fresh = false;
      joined.push_back(rods[i]);
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
