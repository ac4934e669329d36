#include "calibration/core/board.h"

#include <algorithm>
#include <sstream>

namespace vismem {
namespace {

constexpr int kMinSide = 3;
constexpr int kMaxSide = 100;
constexpr double kMinSquare_m = 0.001;
constexpr double kMaxSquare_m = 1.0;
/// Squares that are less square than this come from a wrong ruler, not from a printer.
constexpr double kMaxAspect = 1.1;

}  // namespace

int tagsOf(TagFamily) {
  return 587;
}

int BoardSpec::tagOn(int column, int row) const {
  if (column < 0 || row < 0 || column >= columns || row >= rows || !isWhite(column, row)) return -1;
  // Half of the squares before it, the lower left one of all being black.
  return first_tag + row * columns / 2 + column / 2;
}

Eigen::Vector2i BoardSpec::squareOf(int tag) const {
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (tagOn(column, row) == tag) return {column, row};
    }
  }
  return {-1, -1};
}

std::string checkBoard(const BoardSpec& board) {
  std::ostringstream problem;
  const Eigen::Vector2d& square = board.square_m;
  if (std::min(board.columns, board.rows) < kMinSide || std::max(board.columns, board.rows) > kMaxSide) {
    problem << "board of " << board.columns << "x" << board.rows << " squares (must be " << kMinSide << ".."
            << kMaxSide << " each way)";
  } else if (!(square.minCoeff() >= kMinSquare_m) || !(square.maxCoeff() <= kMaxSquare_m)) {
    problem << "square of " << square.x() << " by " << square.y() << " m (must be " << kMinSquare_m << ".."
            << kMaxSquare_m << ")";
  } else if (square.maxCoeff() > kMaxAspect * square.minCoeff()) {
    problem << "square of " << square.x() << " by " << square.y()
            << " m (must be square within 10 %: were both rulers measured?)";
  } else if (board.first_tag < 0 || board.first_tag + board.tags() > tagsOf(board.family)) {
    problem << "tags " << board.first_tag << ".." << board.first_tag + board.tags() - 1
            << " (the family has 0.." << tagsOf(board.family) - 1 << ")";
  }
  return problem.str();
}

Eigen::Vector3d cornerPosition(const BoardSpec& board, int id) {
  const int column = id % board.cornerColumns();
  const int row = id / board.cornerColumns();
  return {(column + 1) * board.square_m.x(), (row + 1) * board.square_m.y(), 0.0};
}

}  // namespace vismem
