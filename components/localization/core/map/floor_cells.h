/// @file Floor lines near a place: a grid whose cells hold copies of their lines. Pure. See L4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// Floor lines by the cells that they touch, contiguous along a row of cells. Memory grows with the number
/// and the length of the lines; the cell size grows to bound the number of cells. Immutable: *thread-safe*.
class FloorCells {
 public:
  /// @param lines [m], finite; may be points.
  explicit FloorCells(std::span<const Segment2> lines);

  /// Visits every line with a part in the square of half side `reach_m` about a point. Some lines are visited
  /// more than once, and some outside the square.
  template <typename Visit>
  void visitNear(const Eigen::Vector2d& p, double reach_m, Visit visit) const {
    if (lines_.empty()) return;
    const Eigen::Vector2d low = p.array() - reach_m;
    const Eigen::Vector2d high = p.array() + reach_m;
    if (!((low.array() <= high_.array()).all() && (high.array() >= low_.array()).all())) return;
    const std::size_t x_from = cellOf(low.x() - low_.x(), columns_);
    const std::size_t x_to = cellOf(high.x() - low_.x(), columns_);
    const std::size_t y_to = cellOf(high.y() - low_.y(), rows_);
    for (std::size_t y = cellOf(low.y() - low_.y(), rows_); y <= y_to; ++y) {
      const std::uint32_t end = first_[y * columns_ + x_to + 1];
      for (std::uint32_t i = first_[y * columns_ + x_from]; i < end; ++i) {
        const Segment2& line = lines_[i];
        const bool is_beside = (line.a.x() < low.x() && line.b.x() < low.x()) ||
                               (line.a.x() > high.x() && line.b.x() > high.x()) ||
                               (line.a.y() < low.y() && line.b.y() < low.y()) ||
                               (line.a.y() > high.y() && line.b.y() > high.y());
        if (!is_beside) visit(line);
      }
    }
  }

 private:
  std::size_t cellOf(double off_m, std::size_t count) const {
    return static_cast<std::size_t>(std::clamp(off_m * per_m_, 0.0, static_cast<double>(count - 1)));
  }

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();  // of all lines
  Eigen::Vector2d high_ = Eigen::Vector2d::Zero();
  double per_m_ = 1.0;  // cells
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::uint32_t> first_;  // index of each cell's first line, row by row; one more at the end
  std::vector<Segment2> lines_;       // by cell
};

}  // namespace vismem
