/// @file Sampling points of image segments. Pure. Implements L3.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// A point of an observed image segment.
struct ImagePoint {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  ///< ideal pixel
  int label = 0;                                 ///< number in the map index
};

/// Rows whose height grows from the top of the image to its bottom, each cut into square cells. Sizes are
/// those of a 240-row image and scale with the image.
class SamplingGrid {
 public:
  SamplingGrid(int width, int height, double top_px, double bottom_px);

  /// Points where the segment crosses lines of the grid, from a to b.
  std::vector<Eigen::Vector2d> crossings(const Segment2& px) const;
  /// Upper borders of the rows and the image's lower border [px].
  const std::vector<double>& rowBorders() const { return row_borders_; }

 private:
  double width_;
  std::vector<double> row_borders_;
};

}  // namespace vismem
