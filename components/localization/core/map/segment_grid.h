/// @file Exact, truncated distance field: a grid whose cells list the segments that can be nearest. Pure.
/// See L5, L12.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// Vector from the nearest point of the segment to `p`. Inline: most of the time goes here.
inline Eigen::Vector2d awayFromSegment(const Eigen::Vector2d& p, const Segment2& segment) {
  const Eigen::Vector2d way = segment.b - segment.a;
  const Eigen::Vector2d off = p - segment.a;
  // The order of the arguments makes 0 of a point's 0 / 0.
  return off - std::min(1.0, std::max(0.0, off.dot(way) / way.squaredNorm())) * way;
}

/// Distance to the nearest segment, and its derivative by the position.
struct FieldSample {
  double distance_m = 0.0;
  /// Of the distance [m/m], away from the segment; on it, its normal to the left (zero for a point).
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};

/// Distance field of a set of segments by label and direction. Each cell lists the segments that are nearest
/// somewhere in it. Immutable: *thread-safe*.
class SegmentGrid {
 public:
  /// Query for the nearest item of the label that counts for the direction bin.
  struct Question {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    int label = 0;
    int bin = 0;
  };

  struct Item {
    Segment2 plan;  ///< may be a point
    int label = 0;
    std::uint16_t bins = 1;  ///< the direction bins it counts for, one bit each

    bool counts(const Question& question) const {
      return label == question.label && ((bins >> question.bin) & 1) != 0;
    }
  };

  /// @param reach_m truncation distance.
  /// @param cell_m cell size, more in a map of more than a million cells; affects speed only.
  SegmentGrid(std::vector<Item> items, double reach_m, double cell_m);

  /// The nearest item; empty beyond the truncation distance.
  std::optional<FieldSample> nearest(const Question& question) const;
  /// Squared distance only [m^2], truncated at the squared reach.
  double nearestSquare(const Question& question) const;

 private:
  struct Nearest {
    const Item* item;  // null: none within reach
    double square_m2;
  };
  Nearest find(const Question& question) const;
  void listSegments(double cell_m);

  double reach_m_;
  double per_m_ = 1.0;  // cells
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<Item> items_;
  std::vector<std::uint32_t> first_;    // of each cell's members, and the end
  std::vector<std::uint32_t> members_;  // indices of items_, by cell
};

}  // namespace vismem
