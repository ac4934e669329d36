/// @file Exact, truncated distance field: a grid whose cells list the segments that can be nearest. Pure.
/// See L5, L12.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// Distance to the nearest segment, and its derivative by the position.
struct FieldSample {
  double distance_m = 0.0;
  /// Of the distance [m/m], away from the segment; on it, its normal to the left (zero for a point).
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  /// Item::number of the segment.
  std::uint32_t segment = 0;
};

/// Distance field of a large set of segments by label and direction. Each cell lists the segments that are
/// nearest somewhere in it. Memory grows with the length of the segments, not with the area. Each block of
/// cells has its own copy of its segments, so that a query reads few cache lines. Immutable: *thread-safe*.
class SegmentGrid {
 public:
  struct Item {
    Segment2 plan;  ///< may be a point
    int label = 0;
    std::uint16_t bins = 1;    ///< the direction bins it counts for, one bit each
    std::uint32_t number = 0;  ///< returned in FieldSample
  };

  /// Query for the nearest item of the label that counts for the direction bin.
  struct Question {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    int label = 0;
    int bin = 0;
  };

  /// @param reach_m truncation distance.
  /// @param cell_m cell size; affects speed only.
  /// @throws ConfigError if the items spread over more than 2^24 blocks of 16 x 16 cells, if more than 65536
  /// reach into one block, or if they have more than 32768 combinations of label and bins.
  SegmentGrid(std::vector<Item> items, double reach_m, double cell_m);

  double reach() const { return reach_m_; }

  /// The nearest item; empty beyond the truncation distance.
  std::optional<FieldSample> nearest(const Question& question) const;
  /// The same for many queries, whose memory accesses overlap.
  void nearest(std::span<const Question> questions, std::span<std::optional<FieldSample>> samples) const;
  /// Squared distances only [m^2], truncated at the squared reach.
  void nearestSquares(std::span<const Question> questions, std::span<double> squares) const;

 private:
  static constexpr int kBlock = 16;  // cells along a block's side
  static constexpr int kTile = 4;    // cells along the side of a tile, which is contiguous in memory
  static constexpr std::size_t kCells = std::size_t{kBlock} * kBlock;
  static constexpr std::size_t kAtOnce = 128;  // queries; exceeds the outstanding reads of a processor

  struct alignas(32) Line {  // an item, prepared for distances; two per cache line
    double ax, ay, wx, wy;   // begin, and way to the end
    Eigen::Vector2d to(const Eigen::Vector2d& p) const;
  };
  struct Kind {
    int label = 0;
    std::uint16_t bins = 1;
    bool counts(const Question& question) const {
      return ((label == question.label) & (bins >> question.bin)) != 0;
    }
  };
  struct Member {               // of a cell
    std::uint16_t line = 0;     // of the block's
    std::uint16_t kind : 15;    // lines of other kinds are not read
    std::uint16_t is_last : 1;  // of its cell
  };
  struct alignas(64) Block {
    std::array<std::uint32_t, kCells> first;  // of each cell's members; kNone: it has none
  };
  struct BlockOf {
    std::int32_t block = -1;  // of a place; -1: empty
    std::uint32_t lines = 0;  // its first of lines_
  };
  struct Cell {
    const Line* lines;      // of its block
    const Member* members;  // null: none
  };
  struct Place {
    const std::uint32_t* first;  // of its cell's members; null: outside of all blocks
    std::uint32_t lines;
  };
  static constexpr std::uint32_t kNone = 0xFFFF'FFFF;

  FieldSample sampleOf(const Line& line, const Eigen::Vector2d& p) const;
  static std::size_t cellNumber(unsigned x, unsigned y);
  Place placeOf(const Eigen::Vector2d& p) const;
  Cell cellAt(const Place& place) const;
  template <typename Visit>
  void visitTogether(std::span<const Question> questions, Visit visit) const;
  std::uint16_t kindOf(const Item& item);
  std::vector<std::vector<std::uint32_t>> itemsByBlock(std::span<const Item> items, double cell_m);
  void appendBlock(std::span<const Item> items, std::span<const std::uint32_t> near,
                   const Eigen::Vector2d& corner, double cell_m);

  double reach_m_;
  bool is_large_ = false;  // exceeds the near caches: prefetching pays
  double per_m_ = 1.0;     // cells
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::vector<BlockOf> block_of_;
  std::vector<Block> blocks_;
  std::vector<Kind> kinds_;
  std::vector<Member> members_;
  std::vector<Line> lines_;             // by block
  std::vector<std::uint32_t> numbers_;  // of lines_; returned in FieldSample
};

}  // namespace vismem
