/// @file The calibration board: a chessboard whose white squares carry AprilTags for identity, and what a
/// camera sees of it. Pure. Frame of the board: origin in its lower left corner as printed, x right, y up, z
/// out of the paper [m].
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace vismem {

/// Families of tags that a board can carry.
enum class TagFamily { k36h11 };

/// Number of different tags of a family.
int tagsOf(TagFamily family);

/// Squares count from the lower left one, which is black. Corners are where four squares meet: inside the
/// board only.
struct BoardSpec {
  int columns = 9;  ///< squares
  int rows = 6;     ///< squares
  /// One square as measured on the paper, across and up [m]. A printer may scale both ways differently.
  Eigen::Vector2d square_m{0.028, 0.028};
  TagFamily family = TagFamily::k36h11;
  int first_tag = 0;  ///< tag of the first white square; the others follow from left to right, then upwards
  /// Side of a tag's black border, in squares.
  static constexpr double kTagSide = 0.6;

  int cornerColumns() const { return columns - 1; }
  int cornerRows() const { return rows - 1; }
  int corners() const { return cornerColumns() * cornerRows(); }
  /// Corners count from the lower left one, to the right, then upwards.
  int cornerId(int column, int row) const { return row * cornerColumns() + column; }
  bool isWhite(int column, int row) const { return (column + row) % 2 != 0; }
  int tags() const { return columns * rows / 2; }
  /// @return the tag on a square; -1 for black squares and outside the board.
  int tagOn(int column, int row) const;
  /// @return column and row of the square that carries a tag; {-1, -1} when the board does not have it.
  Eigen::Vector2i squareOf(int tag) const;

  bool operator==(const BoardSpec&) const = default;
};

/// @return empty if usable, otherwise the problem: field, value and rule.
std::string checkBoard(const BoardSpec& board);

/// Position of a corner in the board's frame [m]; z is 0. @param id in [0, board.corners()).
Eigen::Vector3d cornerPosition(const BoardSpec& board, int id);

/// A corner in an image.
struct BoardCorner {
  int id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< raw (with distortion), pixel centres on integers [px]
  double sigma_px = 0.0;                            ///< standard deviation each way [px]
};

/// What one image shows of the board; corners are sorted by id.
struct BoardView {
  std::int64_t stamp_us = 0;  ///< of the image
  std::vector<BoardCorner> corners;
};

}  // namespace vismem
