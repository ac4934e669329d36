#include "localization/core/map/floor_cells.h"

#include <cmath>
#include <numeric>
#include <utility>

namespace vismem {
namespace {

constexpr double kCell_m = 4.0;       // smallest cell size
constexpr double kMostCells = 1e6;    // approximate bound
constexpr double kRounding_m = 1e-6;  // tolerance of a line at a cell's border

}  // namespace

FloorCells::FloorCells(std::span<const Segment2> lines) {
  if (lines.empty()) return;
  low_ = high_ = lines.front().a;
  for (const Segment2& line : lines) {
    low_ = low_.cwiseMin(line.a).cwiseMin(line.b);
    high_ = high_.cwiseMax(line.a).cwiseMax(line.b);
  }
  const Eigen::Vector2d extent = high_ - low_;
  // Bounds the number of cells by area, and by side for a map along one line.
  const double cell_m =
      std::max({kCell_m, std::sqrt(extent.prod() / kMostCells), extent.maxCoeff() / kMostCells});
  per_m_ = 1.0 / cell_m;
  columns_ = static_cast<std::size_t>(extent.x() * per_m_) + 1;
  rows_ = static_cast<std::size_t>(extent.y() * per_m_) + 1;
  std::vector<std::pair<std::size_t, std::uint32_t>> members;  // cell, line
  for (std::uint32_t i = 0; i < lines.size(); ++i) {
    const Eigen::Vector2d from = (lines[i].a.cwiseMin(lines[i].b) - low_).array() - kRounding_m;
    const Eigen::Vector2d to = (lines[i].a.cwiseMax(lines[i].b) - low_).array() + kRounding_m;
    for (std::size_t y = cellOf(from.y(), rows_); y <= cellOf(to.y(), rows_); ++y) {
      for (std::size_t x = cellOf(from.x(), columns_); x <= cellOf(to.x(), columns_); ++x) {
        const Eigen::Vector2d corner =
            low_ + cell_m * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
        const Eigen::Vector2d low = corner.array() - kRounding_m;
        const Eigen::Vector2d high = corner.array() + (cell_m + kRounding_m);
        if (clipToBox(lines[i], low, high)) members.emplace_back(y * columns_ + x, i);
      }
    }
  }
  std::sort(members.begin(), members.end());
  first_.assign(columns_ * rows_ + 1, 0);
  lines_.reserve(members.size());
  for (const auto& [cell, line] : members) {
    ++first_[cell + 1];
    lines_.push_back(lines[line]);
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

}  // namespace vismem
