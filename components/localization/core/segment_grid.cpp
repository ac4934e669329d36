#include "localization/core/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

constexpr double kMostBlocks = 1 << 24;
constexpr std::size_t kMostLines = std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1;

constexpr std::size_t kFetch = 32;  // points at a time: more lines of a cache than are on their way at once

/// A set of this size stays in the caches near the processor.
constexpr std::size_t kNearBytes = 512 << 10;

/// A segment that is near a cell: how near its points are at least and at most to the cell's points.
struct Member {
  std::uint16_t line;
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
  const auto near = itemsByBlock(items, cell_m);
  for (std::size_t i = 0; i < block_of_.size(); ++i) {
    if (block_of_[i] < 0) continue;
    const Eigen::Vector2d at(static_cast<double>(i % static_cast<std::size_t>(blocks_x_)),
                             static_cast<double>(i / static_cast<std::size_t>(blocks_x_)));
    const auto& of_block = near[static_cast<std::size_t>(block_of_[i])];
    block_of_[i] = static_cast<std::int32_t>(blocks_.size());  // neighbours side by side
    appendBlock(items, of_block, origin_ + block_m * at, cell_m);
  }
  const std::size_t bytes =
      blocks_.size() * sizeof(Block) + members_.size() * sizeof(std::uint16_t) + lines_.size() * sizeof(Line);
  is_large_ = bytes > kNearBytes;
}

/// The items within reach of each block that has any; block_of_ tells their places in the result.
std::vector<std::vector<std::uint32_t>> SegmentGrid::itemsByBlock(std::span<const Item> items,
                                                                  double cell_m) {
  std::vector<std::vector<std::uint32_t>> near;
  const double block_m = cell_m * kBlock;
  const double within = reach_m_ + std::sqrt(0.5) * block_m;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const Segment2& plan = items[i].plan;
    const Eigen::Vector2d from = (plan.a.cwiseMin(plan.b) - origin_).array() - reach_m_;
    const Eigen::Vector2d to = (plan.a.cwiseMax(plan.b) - origin_).array() + reach_m_;
    const auto block = [&](double value, int count) {
      return std::clamp(static_cast<int>(value / block_m), 0, count - 1);
    };
    for (int y = block(from.y(), blocks_y_); y <= block(to.y(), blocks_y_); ++y) {
      for (int x = block(from.x(), blocks_x_); x <= block(to.x(), blocks_x_); ++x) {
        const Eigen::Vector2d middle = origin_ + block_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        if (distanceToSegment(middle, plan) > within) continue;
        auto& place = block_of_[static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_x_) +
                                static_cast<std::size_t>(x)];
        if (place < 0) {
          place = static_cast<std::int32_t>(near.size());
          near.emplace_back();
        }
        near[static_cast<std::size_t>(place)].push_back(i);
      }
    }
  }
  return near;
}

/// @param near the items that may lie within reach. @param corner of the block, the lower one.
void SegmentGrid::appendBlock(std::span<const Item> items, std::span<const std::uint32_t> near,
                              const Eigen::Vector2d& corner, double cell_m) {
  if (near.size() > kMostLines) {
    std::ostringstream out;
    out << "map: " << near.size() << " segments near (" << corner.transpose() << ") m (must be at most "
        << kMostLines << " within " << cell_m * kBlock << " m)";
    throw ConfigError({out.str()});
  }
  Block block;
  block.lines = lines_.size();
  std::array<std::vector<Member>, kCells> cells;
  const double half_diagonal = std::sqrt(0.5) * cell_m;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Item& item = items[near[i]];
    const Segment2& plan = item.plan;
    const Eigen::Vector2d along = plan.b - plan.a;
    const double length = along.norm();
    const Eigen::Vector2d unit = length > 0.0 ? Eigen::Vector2d(along / length) : Eigen::Vector2d::UnitX();
    lines_.push_back({plan.a.x(), plan.a.y(), unit.x(), unit.y(), length, item.label, item.bins});
    numbers_.push_back(item.number);
    const Eigen::Vector2d from = (plan.a.cwiseMin(plan.b) - corner).array() - reach_m_;
    const Eigen::Vector2d to = (plan.a.cwiseMax(plan.b) - corner).array() + reach_m_;
    const auto cell = [&](double value) { return static_cast<int>(std::clamp(value * per_m_, 0.0, 1e6)); };
    for (int y = cell(from.y()); y <= std::min(cell(to.y()), kBlock - 1); ++y) {
      for (int x = cell(from.x()); x <= std::min(cell(to.x()), kBlock - 1); ++x) {
        const Eigen::Vector2d middle = corner + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        const double distance = distanceToSegment(middle, plan);
        if (distance > reach_m_ + half_diagonal) continue;
        cells[static_cast<std::size_t>(y * kBlock + x)].push_back(
            {static_cast<std::uint16_t>(i), distance - half_diagonal, distance + half_diagonal});
      }
    }
  }
  block.end[0] = static_cast<std::uint32_t>(members_.size());
  for (std::size_t c = 0; c < kCells; ++c) {
    for (const Member& one : cells[c]) {
      // One that is further than another of its kind everywhere in the cell is never the nearest.
      const Line& line = lines_[block.lines + one.line];
      const bool is_beaten = std::any_of(cells[c].begin(), cells[c].end(), [&](const Member& other) {
        const Line& rival = lines_[block.lines + other.line];
        return other.most_m < one.least_m && rival.label == line.label &&
               (rival.bins & line.bins) == line.bins;
      });
      if (!is_beaten) members_.push_back(one.line);
    }
    block.end[c + 1] = static_cast<std::uint32_t>(members_.size());
  }
  blocks_.push_back(block);
}

SegmentGrid::Place SegmentGrid::placeOf(const Eigen::Vector2d& p) const {
  const double x = (p.x() - origin_.x()) * per_m_;
  const double y = (p.y() - origin_.y()) * per_m_;
  // Written so that a NaN falls out as well.
  if (!(x >= 0.0 && y >= 0.0 && x < blocks_x_ * double{kBlock} && y < blocks_y_ * double{kBlock})) return {};
  const auto cell_x = static_cast<unsigned>(x);
  const auto cell_y = static_cast<unsigned>(y);
  const std::int32_t block =
      block_of_[cell_y / kBlock * static_cast<std::size_t>(blocks_x_) + cell_x / kBlock];
  if (block < 0) return {};
  return {&blocks_[static_cast<std::size_t>(block)], cell_y % kBlock * kBlock + cell_x % kBlock};
}

SegmentGrid::Cell SegmentGrid::cellAt(const Place& place) const {
  if (!place.block) return {};
  return {lines_.data() + place.block->lines, members_.data() + place.block->end[place.cell],
          members_.data() + place.block->end[place.cell + 1]};
}

void SegmentGrid::fetch(std::span<const Eigen::Vector2d> points) const {
  if (!is_large_) return;
  std::array<Cell, kFetch> cells;
  for (; !points.empty(); points = points.subspan(std::min(kFetch, points.size()))) {
    const auto some = points.first(std::min(kFetch, points.size()));
    // Each pass needs what the one before asked for: in the meantime it arrives.
    for (const Eigen::Vector2d& p : some) {
      const Place place = placeOf(p);
      if (place.block) __builtin_prefetch(&place.block->end[place.cell]);
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      cells[i] = cellAt(placeOf(some[i]));
      __builtin_prefetch(cells[i].begin);
    }
    for (const Cell& cell : std::span(cells).first(some.size())) {
      for (const std::uint16_t* member = cell.begin; member != cell.end; ++member) {
        __builtin_prefetch(&cell.lines[*member]);
      }
    }
  }
}

SegmentGrid::Found SegmentGrid::find(int label, int bin, const Eigen::Vector2d& p) const {
  const Cell cell = cellAt(placeOf(p));
  Found best;
  best.square = reach_m_ * reach_m_;
  for (const std::uint16_t* member = cell.begin; member != cell.end; ++member) {
    const Line& line = cell.lines[*member];
    if (line.label != label || ((line.bins >> bin) & 1) == 0) continue;
    const double rx = p.x() - line.ax;
    const double ry = p.y() - line.ay;
    const double along = std::min(std::max(rx * line.dx + ry * line.dy, 0.0), line.length);
    const double x = rx - along * line.dx;
    const double y = ry - along * line.dy;
    const double square = x * x + y * y;
    if (square < best.square) best = {&line, square, x, y};
  }
  return best;
}

std::optional<FieldSample> SegmentGrid::nearest(int label, int bin, const Eigen::Vector2d& p) const {
  const Found found = find(label, bin, p);
  if (!found.line) return std::nullopt;
  FieldSample sample;
  sample.distance_m = std::sqrt(found.square);
  if (sample.distance_m > 1e-9) {
    sample.gradient = Eigen::Vector2d(found.x, found.y) / sample.distance_m;
  } else if (found.line->length > 0.0) {
    sample.gradient = {-found.line->dy, found.line->dx};
  }
  sample.segment = numbers_[static_cast<std::size_t>(found.line - lines_.data())];
  return sample;
}

}  // namespace vismem
