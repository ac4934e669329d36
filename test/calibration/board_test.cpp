#include "calibration/core/board.h"

#include <gmock/gmock.h>

namespace vismem {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Three by three squares, W white: row 0 is B W B, row 1 W B W, row 2 B W B.
TEST(BoardSpec, NumbersTagsFromTheLowerLeftToTheRightThenUpwards) {
  BoardSpec board;
  board.columns = board.rows = 3;
  board.first_tag = 10;
  EXPECT_EQ(board.tagOn(0, 0), -1);
  EXPECT_EQ(board.tagOn(1, 0), 10);
  EXPECT_EQ(board.tagOn(0, 1), 11);
  EXPECT_EQ(board.tagOn(2, 1), 12);
  EXPECT_EQ(board.tagOn(1, 2), 13);
  EXPECT_EQ(board.tags(), 4);
  EXPECT_EQ(board.tagOn(3, 0), -1);
  EXPECT_EQ(board.tagOn(-1, 0), -1);
}

TEST(BoardSpec, EverySizeHasEachTagOnce) {
  for (int columns = 3; columns <= 8; ++columns) {
    for (int rows = 3; rows <= 8; ++rows) {
      BoardSpec board;
      board.columns = columns;
      board.rows = rows;
      for (int tag = 0; tag < board.tags(); ++tag) {
        const Eigen::Vector2i square = board.squareOf(tag);
        ASSERT_TRUE(board.isWhite(square.x(), square.y())) << columns << "x" << rows << " tag " << tag;
        EXPECT_EQ(board.tagOn(square.x(), square.y()), tag);
      }
      EXPECT_EQ(board.squareOf(board.tags()), Eigen::Vector2i(-1, -1));
    }
  }
}

TEST(BoardSpec, CornersLieInsideTheBoardInMetres) {
  BoardSpec board;  // 9x6 squares, 8x5 corners
  board.square_m = {0.030, 0.029};
  EXPECT_EQ(board.corners(), 40);
  EXPECT_EQ(cornerPosition(board, 0), Eigen::Vector3d(0.030, 0.029, 0.0));
  // Corner 19 is column 3 of row 2: (4 * 0.030, 3 * 0.029).
  EXPECT_NEAR((cornerPosition(board, board.cornerId(3, 2)) - Eigen::Vector3d(0.120, 0.087, 0.0)).norm(), 0.0,
              1e-12);
}

TEST(BoardSpec, ProblemsNameTheValueAndTheRule) {
  EXPECT_THAT(checkBoard(BoardSpec{}), IsEmpty());
  BoardSpec board;
  board.columns = 2;
  EXPECT_THAT(checkBoard(board), HasSubstr("2x6 squares (must be 3..100"));
  board = {};
  board.square_m.x() = 0.0;
  EXPECT_THAT(checkBoard(board), HasSubstr("square of 0 by 0.028 m"));
  board = {};
  board.square_m.y() = 0.020;
  EXPECT_THAT(checkBoard(board), HasSubstr("were both rulers measured?"));
  board = {};
  board.first_tag = 570;
  EXPECT_THAT(checkBoard(board), HasSubstr("tags 570..596 (the family has 0..586)"));
}

}  // namespace
}  // namespace vismem
