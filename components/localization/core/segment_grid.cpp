#include "localization/core/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

constexpr double kMostBlocks = 1 << 24;

/// A segment that is near a cell: how near its points are at least and at most to the cell's points.
struct Member {
  std::uint32_t item;
  double least_m;
  double most_m;
};

}  // namespace

SegmentGrid::SegmentGrid(std::vector<Item> items, double reach_m, double cell_m)
    : reach_m_(reach_m), per_m_(1.0 / cell_m) {
  if (items.empty()) return;
  Eigen::Vector2d low = items.front().plan.a;
  Eigen::Vector2d high = low;
  for (const Item& item : items) {
    low = low.cwiseMin(item.plan.a).cwiseMin(item.plan.b);
    high = high.cwiseMax(item.plan.a).cwiseMax(item.plan.b);
    const Eigen::Vector2d along = item.plan.b - item.plan.a;
    const double length = along.norm();
    const Eigen::Vector2d unit = length > 0.0 ? Eigen::Vector2d(along / length) : Eigen::Vector2d::UnitX();
    lines_.push_back(
        {item.plan.a.x(), item.plan.a.y(), unit.x(), unit.y(), length, item.label, item.number, item.bins});
  }
  origin_ = low.array() - reach_m;
  const double block_m = cell_m * kBlock;
  const Eigen::Vector2d blocks = ((high - low).array() + 2.0 * reach_m) / block_m;
  if (!(blocks.x() * blocks.y() < kMostBlocks)) {
    std::ostringstream out;
    out << "map: its segments spread over " << (high - low).x() << " x " << (high - low).y()
        << " m (too far for an index with cells of " << cell_m << " m)";
    throw ConfigError({out.str()});
  }
  blocks_x_ = static_cast<int>(blocks.x()) + 1;
  blocks_y_ = static_cast<int>(blocks.y()) + 1;
  block_of_.assign(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_), -1);

  std::vector<std::vector<Member>> cells;
  const double half_diagonal = std::sqrt(0.5) * cell_m;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const Segment2& plan = items[i].plan;
    const Eigen::Vector2d from = (plan.a.cwiseMin(plan.b) - origin_).array() - reach_m;
    const Eigen::Vector2d to = (plan.a.cwiseMax(plan.b) - origin_).array() + reach_m;
    const auto cell = [&](double value) { return std::max(0, static_cast<int>(value * per_m_)); };
    const int last_y = std::min(cell(to.y()), blocks_y_ * kBlock - 1);
    const int last_x = std::min(cell(to.x()), blocks_x_ * kBlock - 1);
    for (int y = cell(from.y()); y <= last_y; ++y) {
      for (int x = cell(from.x()); x <= last_x; ++x) {
        const Eigen::Vector2d middle = origin_ + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        const double distance = distanceToSegment(middle, plan);
        if (distance > reach_m + half_diagonal) continue;
        auto& block = block_of_[static_cast<std::size_t>(y / kBlock) * static_cast<std::size_t>(blocks_x_) +
                                static_cast<std::size_t>(x / kBlock)];
        if (block < 0) {
          block = static_cast<std::int32_t>(cells.size() / (kBlock * kBlock));
          cells.resize(cells.size() + kBlock * kBlock);
        }
        cells[static_cast<std::size_t>(block) * kBlock * kBlock +
              static_cast<std::size_t>(y % kBlock * kBlock + x % kBlock)]
            .push_back({i, distance - half_diagonal, distance + half_diagonal});
      }
    }
  }
  for (const auto& members : cells) {
    first_.push_back(static_cast<std::uint32_t>(members_.size()));
    for (const Member& one : members) {
      // One that is further than another of its kind everywhere in the cell is never the nearest.
      const Item& item = items[one.item];
      const bool is_beaten = std::any_of(members.begin(), members.end(), [&](const Member& other) {
        return other.most_m < one.least_m && items[other.item].label == item.label &&
               (items[other.item].bins & item.bins) == item.bins;
      });
      if (!is_beaten) members_.push_back(one.item);
    }
  }
  first_.push_back(static_cast<std::uint32_t>(members_.size()));
}

std::optional<std::size_t> SegmentGrid::cellOf(const Eigen::Vector2d& p) const {
  const double x = (p.x() - origin_.x()) * per_m_;
  const double y = (p.y() - origin_.y()) * per_m_;
  // Written so that a NaN falls out as well.
  if (!(x >= 0.0 && y >= 0.0 && x < blocks_x_ * double{kBlock} && y < blocks_y_ * double{kBlock})) {
    return std::nullopt;
  }
  const auto cell_x = static_cast<unsigned>(x);
  const auto cell_y = static_cast<unsigned>(y);
  const std::int32_t block =
      block_of_[cell_y / kBlock * static_cast<std::size_t>(blocks_x_) + cell_x / kBlock];
  if (block < 0) return std::nullopt;
  return static_cast<std::size_t>(block) * kBlock * kBlock + cell_y % kBlock * kBlock + cell_x % kBlock;
}

std::optional<FieldSample> SegmentGrid::nearest(int label, int bin, const Eigen::Vector2d& p) const {
  const auto cell = cellOf(p);
  if (!cell) return std::nullopt;
  double best = reach_m_ * reach_m_;
  double best_x = 0.0;
  double best_y = 0.0;
  const Line* nearest = nullptr;
  for (std::uint32_t i = first_[*cell]; i < first_[*cell + 1]; ++i) {
    const Line& line = lines_[members_[i]];
    if (line.label != label || ((line.bins >> bin) & 1) == 0) continue;
    const double rx = p.x() - line.ax;
    const double ry = p.y() - line.ay;
    const double along = std::min(std::max(rx * line.dx + ry * line.dy, 0.0), line.length);
    const double x = rx - along * line.dx;
    const double y = ry - along * line.dy;
    const double square = x * x + y * y;
    if (square >= best) continue;
    best = square;
    best_x = x;
    best_y = y;
    nearest = &line;
  }
  if (!nearest) return std::nullopt;
  FieldSample sample;
  sample.distance_m = std::sqrt(best);
  if (sample.distance_m > 1e-9) {
    sample.gradient = Eigen::Vector2d(best_x, best_y) / sample.distance_m;
  } else if (nearest->length > 0.0) {
    sample.gradient = {-nearest->dy, nearest->dx};
  }
  sample.segment = nearest->number;
  return sample;
}

}  // namespace vismem
