#include "localization/core/map/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kMostCells = 1 << 20;

/// A segment near a cell, with bounds of its distance from the cell's points.
struct NearCell {
  std::uint32_t item;
  double least_m;
  double most_m;
};

}  // namespace

SegmentGrid::SegmentGrid(std::vector<Item> items, double reach_m, double cell_m)
    : reach_m_(reach_m), items_(std::move(items)) {
  if (items_.empty()) return;
  Eigen::Vector2d low = items_.front().plan.a;
  Eigen::Vector2d high = low;
  for (const Item& item : items_) {
    low = low.cwiseMin(item.plan.a).cwiseMin(item.plan.b);
    high = high.cwiseMax(item.plan.a).cwiseMax(item.plan.b);
  }
  origin_ = low.array() - reach_m;
  const Eigen::Vector2d extent = (high - low).array() + 2.0 * reach_m;
  cell_m = std::max(cell_m, std::sqrt(extent.prod() / kMostCells));
  per_m_ = 1.0 / cell_m;
  columns_ = static_cast<std::size_t>(extent.x() * per_m_) + 1;
  rows_ = static_cast<std::size_t>(extent.y() * per_m_) + 1;
  listSegments(cell_m);
}

void SegmentGrid::listSegments(double cell_m) {
  std::vector<std::vector<NearCell>> cells(columns_ * rows_);
  const double half_diagonal = std::sqrt(0.5) * cell_m;
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    const Segment2& plan = items_[i].plan;
    const Eigen::Vector2d from = ((plan.a.cwiseMin(plan.b) - origin_).array() - reach_m_) * per_m_;
    const Eigen::Vector2d to = ((plan.a.cwiseMax(plan.b) - origin_).array() + reach_m_) * per_m_;
    const auto cell = [](double value, std::size_t count) {
      return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
    };
    for (std::size_t y = cell(from.y(), rows_); y <= cell(to.y(), rows_); ++y) {
      for (std::size_t x = cell(from.x(), columns_); x <= cell(to.x(), columns_); ++x) {
        const Eigen::Vector2d corner(static_cast<double>(x), static_cast<double>(y));
        const Eigen::Vector2d middle = origin_ + cell_m * (corner + Eigen::Vector2d::Constant(0.5));
        const double distance = distanceToSegment(middle, plan);
        if (distance > reach_m_ + half_diagonal) continue;
        cells[y * columns_ + x].push_back({i, distance - half_diagonal, distance + half_diagonal});
      }
    }
  }
  for (const std::vector<NearCell>& near : cells) {
    first_.push_back(static_cast<std::uint32_t>(members_.size()));
    for (const NearCell& one : near) {
      // A segment further than another of its kind everywhere in the cell is never the nearest.
      const Item& item = items_[one.item];
      const bool is_beaten = std::any_of(near.begin(), near.end(), [&](const NearCell& other) {
        const Item& rival = items_[other.item];
        return other.most_m < one.least_m && rival.label == item.label &&
               (rival.bins & item.bins) == item.bins;
      });
      if (!is_beaten) members_.push_back(one.item);
    }
  }
  first_.push_back(static_cast<std::uint32_t>(members_.size()));
}

SegmentGrid::Nearest SegmentGrid::find(const Question& question) const {
  Nearest nearest{nullptr, reach_m_ * reach_m_};
  const double x = (question.p.x() - origin_.x()) * per_m_;
  const double y = (question.p.y() - origin_.y()) * per_m_;
  // Written so that NaN is outside, too.
  if (!(x >= 0.0 && y >= 0.0 && x < static_cast<double>(columns_) && y < static_cast<double>(rows_))) {
    return nearest;
  }
  const std::size_t cell = static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x);
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
    const Item& item = items_[members_[i]];
    if (!item.counts(question)) continue;
    const double square = awayFromSegment(question.p, item.plan).squaredNorm();
    if (square < nearest.square_m2) nearest = {&item, square};
  }
  return nearest;
}

double SegmentGrid::nearestSquare(const Question& question) const {
  return find(question).square_m2;
}

std::optional<FieldSample> SegmentGrid::nearest(const Question& question) const {
  const Nearest found = find(question);
  if (!found.item) return std::nullopt;
  const Segment2& plan = found.item->plan;
  FieldSample sample;
  sample.distance_m = std::sqrt(found.square_m2);
  if (sample.distance_m > 1e-9) {
    sample.gradient = awayFromSegment(question.p, plan) / sample.distance_m;
  } else if (plan.length() > 0.0) {
    sample.gradient = turned90((plan.b - plan.a).normalized());
  }
  return sample;
}

}  // namespace vismem
