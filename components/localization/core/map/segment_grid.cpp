#include "localization/core/map/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

constexpr double kMostBlocks = 1 << 24;
constexpr std::size_t kMostLines = std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1;

constexpr std::size_t kMostKinds = 1 << 15;

/// Size of the near caches.
constexpr std::size_t kNearBytes = 512 << 10;

/// A segment near a cell, with bounds of its distance from the cell's points.
struct NearCell {
  std::uint16_t line;
  std::uint16_t kind;
  double least_m;
  double most_m;
};

}  // namespace

/// Vector from the nearest point of the line to `p`.
inline Eigen::Vector2d SegmentGrid::Line::to(const Eigen::Vector2d& p) const {
  const double rx = p.x() - ax;
  const double ry = p.y() - ay;
  // The order of the arguments makes 0 of a point's 0 / 0.
  const double fraction = std::min(1.0, std::max(0.0, (rx * wx + ry * wy) / (wx * wx + wy * wy)));
  return {rx - fraction * wx, ry - fraction * wy};
}

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
  block_of_.assign(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_), {});
  const auto near = itemsByBlock(items, cell_m);
  for (std::size_t i = 0; i < block_of_.size(); ++i) {
    if (block_of_[i].block < 0) continue;
    const Eigen::Vector2d at(static_cast<double>(i % static_cast<std::size_t>(blocks_x_)),
                             static_cast<double>(i / static_cast<std::size_t>(blocks_x_)));
    const auto& of_block = near[static_cast<std::size_t>(block_of_[i].block)];
    // Neighbouring blocks are adjacent in memory.
    block_of_[i] = {static_cast<std::int32_t>(blocks_.size()), static_cast<std::uint32_t>(lines_.size())};
    appendBlock(items, of_block, origin_ + block_m * at, cell_m);
  }
  const std::size_t bytes =
      blocks_.size() * sizeof(Block) + members_.size() * sizeof(Member) + lines_.size() * sizeof(Line);
  is_large_ = bytes > kNearBytes;
}

/// The items within reach of each block; block_of_ holds the index of each block with items.
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
                                static_cast<std::size_t>(x)]
                          .block;
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

/// @param near items that may lie within reach.
/// @param corner lower corner of the block.
void SegmentGrid::appendBlock(std::span<const Item> items, std::span<const std::uint32_t> near,
                              const Eigen::Vector2d& corner, double cell_m) {
  if (near.size() > kMostLines) {
    std::ostringstream out;
    out << "map: " << near.size() << " segments near (" << corner.transpose() << ") m (must be at most "
        << kMostLines << " within " << cell_m * kBlock << " m)";
    throw ConfigError({out.str()});
  }
  Block block;
  block.first.fill(kNone);
  std::array<std::vector<NearCell>, kCells> cells;
  const double half_diagonal = std::sqrt(0.5) * cell_m;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Item& item = items[near[i]];
    const Segment2& plan = item.plan;
    const Eigen::Vector2d way = plan.b - plan.a;
    const std::uint16_t kind = kindOf(item);
    lines_.push_back({plan.a.x(), plan.a.y(), way.x(), way.y()});
    numbers_.push_back(item.number);
    const Eigen::Vector2d from = (plan.a.cwiseMin(plan.b) - corner).array() - reach_m_;
    const Eigen::Vector2d to = (plan.a.cwiseMax(plan.b) - corner).array() + reach_m_;
    const auto cell = [&](double value) { return static_cast<int>(std::clamp(value * per_m_, 0.0, 1e6)); };
    for (int y = cell(from.y()); y <= std::min(cell(to.y()), kBlock - 1); ++y) {
      for (int x = cell(from.x()); x <= std::min(cell(to.x()), kBlock - 1); ++x) {
        const Eigen::Vector2d middle = corner + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        const double distance = distanceToSegment(middle, plan);
        if (distance > reach_m_ + half_diagonal) continue;
        cells[cellNumber(static_cast<unsigned>(x), static_cast<unsigned>(y))].push_back(
            {static_cast<std::uint16_t>(i), kind, distance - half_diagonal, distance + half_diagonal});
      }
    }
  }
  for (std::size_t c = 0; c < kCells; ++c) {
    const std::size_t first = members_.size();
    for (const NearCell& one : cells[c]) {
      // A segment further than another of its kind everywhere in the cell is never the nearest.
      const Kind& kind = kinds_[one.kind];
      const bool is_beaten = std::any_of(cells[c].begin(), cells[c].end(), [&](const NearCell& other) {
        const Kind& rival = kinds_[other.kind];
        return other.most_m < one.least_m && rival.label == kind.label &&
               (rival.bins & kind.bins) == kind.bins;
      });
      if (!is_beaten) members_.push_back({one.line, one.kind, 0});
    }
    if (members_.size() == first) continue;
    members_.back().is_last = 1;
    block.first[c] = static_cast<std::uint32_t>(first);
  }
  blocks_.push_back(block);
}

/// @return index of the item's kind, which is added if new.
std::uint16_t SegmentGrid::kindOf(const Item& item) {
  std::size_t kind = 0;
  while (kind < kinds_.size() && (kinds_[kind].label != item.label || kinds_[kind].bins != item.bins)) ++kind;
  if (kind == kinds_.size()) kinds_.push_back({item.label, item.bins});
  if (kind < kMostKinds) return static_cast<std::uint16_t>(kind);
  std::ostringstream out;
  out << "map: segments of more than " << kMostKinds << " kinds (labels and directions)";
  throw ConfigError({out.str()});
}

/// Index of a cell within its block, tile by tile.
std::size_t SegmentGrid::cellNumber(unsigned x, unsigned y) {
  constexpr unsigned kTiles = kBlock / kTile;
  return (y / kTile * kTiles + x / kTile) * (kTile * kTile) + y % kTile * kTile + x % kTile;
}

SegmentGrid::Place SegmentGrid::placeOf(const Eigen::Vector2d& p) const {
  const double x = (p.x() - origin_.x()) * per_m_;
  const double y = (p.y() - origin_.y()) * per_m_;
  // Written so that NaN is outside, too.
  if (!(x >= 0.0 && y >= 0.0 && x < blocks_x_ * double{kBlock} && y < blocks_y_ * double{kBlock})) {
    return {nullptr, 0};
  }
  const auto cell_x = static_cast<unsigned>(x);
  const auto cell_y = static_cast<unsigned>(y);
  const BlockOf& of = block_of_[cell_y / kBlock * static_cast<std::size_t>(blocks_x_) + cell_x / kBlock];
  if (of.block < 0) return {nullptr, 0};
  const Block& block = blocks_[static_cast<std::size_t>(of.block)];
  return {&block.first[cellNumber(cell_x % kBlock, cell_y % kBlock)], of.lines};
}

SegmentGrid::Cell SegmentGrid::cellAt(const Place& place) const {
  if (!place.first || *place.first == kNone) return {nullptr, nullptr};
  return {lines_.data() + place.lines, members_.data() + *place.first};
}

/// Visits every line that may answer one of the queries, with the query's index. Each pass prefetches what
/// the next one reads.
/// @param questions at most kAtOnce.
template <typename Visit>
void SegmentGrid::visitTogether(std::span<const Question> questions, Visit visit) const {
  std::array<Place, kAtOnce> places;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    places[i] = placeOf(questions[i].p);
    if (is_large_) __builtin_prefetch(places[i].first);
  }
  std::array<Cell, kAtOnce> cells;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    cells[i] = cellAt(places[i]);
    if (is_large_) __builtin_prefetch(cells[i].members);
  }
  struct Candidate {
    const Line* line;
    std::size_t question;
  };
  std::array<Candidate, 4 * kAtOnce> candidates;
  std::size_t count = 0;
  const auto visitAll = [&] {
    if (is_large_) {
      for (const Candidate& one : std::span(candidates).first(count)) __builtin_prefetch(one.line);
    }
    for (const Candidate& one : std::span(candidates).first(count)) visit(*one.line, one.question);
    count = 0;
  };
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const Member* member = cells[i].members;
    for (bool more = member; more; ++member) {
      // Without a branch, because it would be unpredictable.
      candidates[count] = {cells[i].lines + member->line, i};
      count += kinds_[member->kind].counts(questions[i]) ? 1 : 0;
      if (count == candidates.size()) visitAll();
      more = !member->is_last;
    }
  }
  visitAll();
}

void SegmentGrid::nearestSquares(std::span<const Question> questions, std::span<double> squares) const {
  std::fill_n(squares.begin(), questions.size(), reach_m_ * reach_m_);
  while (!questions.empty()) {
    const std::size_t count = std::min(kAtOnce, questions.size());
    visitTogether(questions.first(count), [&](const Line& line, std::size_t i) {
      squares[i] = std::min(squares[i], line.to(questions[i].p).squaredNorm());
    });
    questions = questions.subspan(count);
    squares = squares.subspan(count);
  }
}

FieldSample SegmentGrid::sampleOf(const Line& line, const Eigen::Vector2d& p) const {
  const Eigen::Vector2d away = line.to(p);
  FieldSample sample;
  sample.distance_m = std::sqrt(away.squaredNorm());
  const Eigen::Vector2d way(line.wx, line.wy);
  if (sample.distance_m > 1e-9) {
    sample.gradient = away / sample.distance_m;
  } else if (way.squaredNorm() > 0.0) {
    sample.gradient = Eigen::Vector2d(-way.y(), way.x()).normalized();
  }
  sample.segment = numbers_[static_cast<std::size_t>(&line - lines_.data())];
  return sample;
}

std::optional<FieldSample> SegmentGrid::nearest(const Question& question) const {
  const Cell cell = cellAt(placeOf(question.p));
  const Line* nearest = nullptr;
  double least = reach_m_ * reach_m_;
  const Member* member = cell.members;
  for (bool more = member; more; ++member) {
    more = !member->is_last;
    if (!kinds_[member->kind].counts(question)) continue;
    const Line& line = cell.lines[member->line];
    const double square = line.to(question.p).squaredNorm();
    if (square >= least) continue;
    least = square;
    nearest = &line;
  }
  if (!nearest) return std::nullopt;
  return sampleOf(*nearest, question.p);
}

void SegmentGrid::nearest(std::span<const Question> questions,
                          std::span<std::optional<FieldSample>> samples) const {
  std::array<double, kAtOnce> squares;
  std::array<const Line*, kAtOnce> lines;
  while (!questions.empty()) {
    const std::size_t count = std::min(kAtOnce, questions.size());
    std::fill_n(squares.begin(), count, reach_m_ * reach_m_);
    std::fill_n(lines.begin(), count, nullptr);
    visitTogether(questions.first(count), [&](const Line& line, std::size_t i) {
      const double square = line.to(questions[i].p).squaredNorm();
      lines[i] = square < squares[i] ? &line : lines[i];
      squares[i] = std::min(square, squares[i]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      samples[i].reset();
      if (lines[i]) samples[i] = sampleOf(*lines[i], questions[i].p);
    }
    questions = questions.subspan(count);
    samples = samples.subspan(count);
  }
}

}  // namespace vismem
