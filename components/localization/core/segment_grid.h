/// @file Which segment of the map is nearest: a grid whose cells know the few that can be. Pure. DESIGN 9
/// part 1.
#pragma once

#include <Eigen/Core>
#include <array>
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
/// area. What a block of cells needs lies together, its own copy of the segments included: questions about
/// one place stay within a few pages, however large the set. Immutable: *thread-safe*.
class SegmentGrid {
 public:
  struct Item {
    Segment2 plan;             ///< may be a point
    int label = 0;             ///< asked for by number
    std::uint16_t bins = 1;    ///< the directions it counts for, a bit each
    std::uint32_t number = 0;  ///< told in answers
  };

  /// @param reach_m larger distances are not found. @param cell_m of the grid; changes speed alone.
  /// @throws ConfigError when the items spread over more than 2^24 blocks of 16 x 16 cells, and when more
  /// than 65536 of them reach into one block.
  SegmentGrid(std::vector<Item> items, double reach_m, double cell_m);

  double reach() const { return reach_m_; }

  /// Begins to read what questions about these points will need, all at once: in a large set the answers wait
  /// for memory, one after another. Changes speed alone.
  void fetch(std::span<const Eigen::Vector2d> points) const;

  /// The nearest item of the label that counts for the bin; empty beyond the reach.
  std::optional<FieldSample> nearest(int label, int bin, const Eigen::Vector2d& p) const;
  /// Its distance alone, squared [m^2]; the reach's beyond the reach.
  double nearestSquare(int label, int bin, const Eigen::Vector2d& p) const {
    return find(label, bin, p).square;
  }

 private:
  static constexpr int kBlock = 16;  // cells along a block's side
  static constexpr int kCells = kBlock * kBlock;

  struct Line {             // an item, ready to measure
    double ax, ay, dx, dy;  // begin, and unit direction
    double length;
    std::int32_t label;
    std::uint16_t bins;
  };
  struct Block {
    std::size_t lines = 0;  // its first of lines_
    std::array<std::uint32_t, kCells + 1>
        end;  // of each cell's part of members_, after where the first begins
  };
  struct Cell {
    const Line* lines = nullptr;  // of its block
    const std::uint16_t* begin = nullptr;
    const std::uint16_t* end = nullptr;
  };
  struct Place {
    const Block* block = nullptr;  // null: outside of all
    std::size_t cell = 0;
  };
  struct Found {
    const Line* line = nullptr;
    double square;            // of the distance
    double x = 0.0, y = 0.0;  // from the line to the point
  };
  Found find(int label, int bin, const Eigen::Vector2d& p) const;
  Place placeOf(const Eigen::Vector2d& p) const;
  Cell cellAt(const Place& place) const;
  std::vector<std::vector<std::uint32_t>> itemsByBlock(std::span<const Item> items, double cell_m);
  void appendBlock(std::span<const Item> items, std::span<const std::uint32_t> near,
                   const Eigen::Vector2d& corner, double cell_m);

  double reach_m_;
  bool is_large_ = false;
  double per_m_ = 1.0;  // cells
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::vector<std::int32_t> block_of_;  // -1: empty
  std::vector<Block> blocks_;
  std::vector<std::uint16_t> members_;  // of cells: which of the block's lines
  std::vector<Line> lines_;             // by block
  std::vector<std::uint32_t> numbers_;  // of lines_, told in answers
};

}  // namespace vismem
