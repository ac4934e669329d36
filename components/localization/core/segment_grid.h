/// @file Which segment of the map is nearest: a grid whose cells know the few that can be. Pure. DESIGN 9
/// part 1.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// Distance to the nearest of a set, and its derivative by the position.
struct FieldSample {
  double distance_m = 0.0;
  /// Of the distance [m/m], away from the segment; on it, its normal to the left (zero for a point).
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  /// Number of the segment among those that the set was made of.
  std::uint32_t segment = 0;
};

/// The distance field of a large set of segments of many kinds, exact and truncated: each cell lists the
/// segments that are nearest somewhere in it. Memory grows with the length of the segments, not with the
/// area. Immutable: *thread-safe*.
class SegmentGrid {
 public:
  struct Item {
    Segment2 plan;             ///< may be a point
    int label = 0;             ///< asked for by number
    std::uint16_t bins = 1;    ///< the directions it counts for, a bit each
    std::uint32_t number = 0;  ///< told in answers
  };

  /// @param reach_m larger distances are not found. @param cell_m of the grid; changes speed alone.
  /// @throws ConfigError when the items spread over more than 2^24 blocks of 16 x 16 cells.
  SegmentGrid(std::vector<Item> items, double reach_m, double cell_m);

  /// The nearest item of the label that counts for the bin; empty beyond the reach.
  std::optional<FieldSample> nearest(int label, int bin, const Eigen::Vector2d& p) const;

 private:
  static constexpr int kBlock = 16;  // cells along a block's side

  struct Line {             // an item, ready to measure
    double ax, ay, dx, dy;  // begin, and unit direction
    double length;
    std::int32_t label;
    std::uint32_t number;
    std::uint16_t bins;
  };
  /// Cell of a point; empty outside of all.
  std::optional<std::size_t> cellOf(const Eigen::Vector2d& p) const;

  double reach_m_;
  double per_m_ = 1.0;  // cells
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::vector<std::int32_t> block_of_;  // -1: empty
  std::vector<std::uint32_t> first_;    // [block * 256 + cell]: into members_; one more at the end
  std::vector<std::uint32_t> members_;  // into lines_
  std::vector<Line> lines_;
};

}  // namespace vismem
