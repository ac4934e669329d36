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
/// area. What a block of cells needs lies together, its own copy of the segments included, and what a
/// question reads of it fits into few lines of a cache: in a large set the answers wait for memory.
/// Immutable: *thread-safe*.
class SegmentGrid {
 public:
  struct Item {
    Segment2 plan;             ///< may be a point
    int label = 0;             ///< asked for by number
    std::uint16_t bins = 1;    ///< the directions it counts for, a bit each
    std::uint32_t number = 0;  ///< told in answers
  };

  /// For the nearest item of the label that counts for the bin.
  struct Question {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    int label = 0;
    int bin = 0;
  };

  /// @param reach_m larger distances are not found. @param cell_m of the grid; changes speed alone.
  /// @throws ConfigError when the items spread over more than 2^24 blocks of 16 x 16 cells, when more than
  /// 65536 of them reach into one block, or when they are of more than 32768 kinds (label and bins).
  SegmentGrid(std::vector<Item> items, double reach_m, double cell_m);

  double reach() const { return reach_m_; }

  /// The nearest item; empty beyond the reach.
  std::optional<FieldSample> nearest(const Question& question) const;
  /// The same for as many questions: what they need is read all at once and not one after another.
  void nearest(std::span<const Question> questions, std::span<std::optional<FieldSample>> samples) const;
  /// Distances alone, squared [m^2], to as many questions; the reach's beyond the reach.
  void nearestSquares(std::span<const Question> questions, std::span<double> squares) const;

 private:
  static constexpr int kBlock = 16;  // cells along a block's side
  static constexpr int kTile = 4;    // cells along the side of a part of it that lies together
  static constexpr std::size_t kCells = std::size_t{kBlock} * kBlock;
  static constexpr std::size_t kAtOnce = 128;  // questions: more than a processor reads for at a time

  struct alignas(32) Line {  // an item, ready to measure; two in a line of a cache
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
    std::uint16_t kind : 15;    // lines of other kinds need not be read
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
  bool is_large_ = false;  // it pays to read ahead: a small set stays in the caches near the processor
  double per_m_ = 1.0;     // cells
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::vector<BlockOf> block_of_;
  std::vector<Block> blocks_;
  std::vector<Kind> kinds_;
  std::vector<Member> members_;
  std::vector<Line> lines_;             // by block
  std::vector<std::uint32_t> numbers_;  // of lines_, told in answers
};

}  // namespace vismem
