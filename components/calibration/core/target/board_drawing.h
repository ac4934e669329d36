/// @file The printed board as a list of black rectangles and texts. Pure.
#pragma once

#include <string>
#include <vector>

#include "calibration/core/board.h"

namespace vismem {

struct Paper {
  std::string name;
  double width_mm = 0.0;  ///< the longer side
  double height_mm = 0.0;
};

/// A4, A3, A2, A1. @throw ConfigError for another name.
Paper paperNamed(const std::string& name);

/// Axis-parallel, from the page's lower left corner [mm].
struct PrintedRectangle {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

struct PrintedText {
  double x = 0.0;
  double y = 0.0;
  double size = 3.0;  ///< height of a capital letter, about [mm]
  std::string text;
  bool upwards = false;  ///< turned by 90 degrees to the left
};

struct PrintedPage {
  double width_mm = 0.0;
  double height_mm = 0.0;
  std::vector<PrintedRectangle> black;
  std::vector<PrintedText> texts;
  /// Lower left corner of the chessboard.
  Eigen::Vector2d origin_mm = Eigen::Vector2d::Zero();
};

/// Length of both rulers [mm].
inline constexpr double kRuler_mm = 100.0;
/// Printers leave this much of each side white [mm].
inline constexpr double kPaperMargin_mm = 12.0;

/// The largest square of whole millimetres with which a board and its rulers fit on a paper [mm].
/// @throw ConfigError when none of at least 5 mm fits.
double largestSquare_mm(const BoardSpec& board, const Paper& paper);

/// The board with a ruler below and one beside it. @throw ConfigError when it does not fit.
PrintedPage drawBoard(const BoardSpec& board, const Paper& paper);

/// Cuts a page into parts that are printed on smaller paper and glued together, with marks where to cut, from
/// the upper left part to the right, then downwards.
std::vector<PrintedPage> tilePage(const PrintedPage& page, const Paper& tile);

}  // namespace vismem
