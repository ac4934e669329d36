#include "calibration/core/target/board_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "calibration/core/target/tag_pattern.h"
#include "common/config/config_error.h"

namespace vismem {
namespace {

/// Room for a ruler and its text, left of and below the chessboard [mm].
constexpr double kRulerRoom_mm = 12.0;
constexpr double kThin_mm = 0.25;
constexpr double kSmallestSquare_mm = 5.0;

Eigen::Vector2d roomFor(const Paper& paper) {
  return {paper.width_mm - 2 * kPaperMargin_mm - kRulerRoom_mm,
          paper.height_mm - 2 * kPaperMargin_mm - kRulerRoom_mm};
}

std::string inMm(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void addTag(std::vector<PrintedRectangle>& black, const TagPattern& tag, const Eigen::Vector2d& lower_left,
            double side_mm) {
  const double module = side_mm / TagPattern::kModules;
  for (int row = 0; row < TagPattern::kModules; ++row) {
    const auto& line = tag.black[row];
    const double y = lower_left.y() + (TagPattern::kModules - 1 - row) * module;
    // Runs of black modules, so that viewers show no seams between them.
    for (int begin = 0; begin < TagPattern::kModules; ++begin) {
      if (!line[begin]) continue;
      int end = begin;
      while (end < TagPattern::kModules && line[end]) ++end;
      black.push_back({lower_left.x() + begin * module, y, (end - begin) * module, module});
      begin = end;
    }
  }
}

void addSquares(PrintedPage& page, const BoardSpec& board, const Eigen::Vector2d& square) {
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Eigen::Vector2d at = page.origin_mm + Eigen::Vector2d(column * square.x(), row * square.y());
      if (!board.isWhite(column, row)) {
        page.black.push_back({at.x(), at.y(), square.x(), square.y()});
        continue;
      }
      const double side = BoardSpec::kTagSide * std::min(square.x(), square.y());
      addTag(page.black, tagPattern(board.family, board.tagOn(column, row)),
             at + 0.5 * (square - Eigen::Vector2d::Constant(side)), side);
    }
  }
}

/// Ticks each 10 mm; the outer borders of the first and the last tick are the ruler's ends.
void addRulers(PrintedPage& page) {
  const double below = page.origin_mm.y() - 4.0;
  const double beside = page.origin_mm.x() - 4.0;
  page.black.push_back({page.origin_mm.x(), below - kThin_mm, kRuler_mm, kThin_mm});
  page.black.push_back({beside - kThin_mm, page.origin_mm.y(), kThin_mm, kRuler_mm});
  constexpr int kTicks = 10;
  for (int tick = 0; tick <= kTicks; ++tick) {
    const double length = tick % 5 == 0 ? 3.0 : 1.5;
    const double at = tick * (kRuler_mm - kThin_mm) / kTicks;
    page.black.push_back({page.origin_mm.x() + at, below - length, kThin_mm, length});
    page.black.push_back({beside - length, page.origin_mm.y() + at, length, kThin_mm});
  }
}

void addTexts(PrintedPage& page, const BoardSpec& board, const Eigen::Vector2d& square) {
  std::ostringstream text;
  text << "Print at 100 %, on stiff flat paper. This ruler has 100 mm: measure both. Board of "
       << board.columns << " x " << board.rows << " squares of " << inMm(square.x()) << " mm, tag36h11 from "
       << board.first_tag << ".";
  page.texts.push_back({page.origin_mm.x(), page.origin_mm.y() - 11.0, 2.5, text.str(), false});
  page.texts.push_back({page.origin_mm.x() - 8.5, page.origin_mm.y(), 2.5, "100 mm", true});
}

/// The part of a rectangle inside a window, or one without area.
PrintedRectangle clipped(const PrintedRectangle& r, const PrintedRectangle& window) {
  const double left = std::max(r.x, window.x);
  const double bottom = std::max(r.y, window.y);
  const double right = std::min(r.x + r.width, window.x + window.width);
  const double top = std::min(r.y + r.height, window.y + window.height);
  return {left, bottom, std::max(0.0, right - left), std::max(0.0, top - bottom)};
}

/// Short lines outside a window's four corners.
void addCutMarks(std::vector<PrintedRectangle>& black, const PrintedRectangle& window) {
  constexpr double kLength_mm = 6.0;
  constexpr double kGap_mm = 1.0;
  for (const double x : {window.x, window.x + window.width}) {
    for (const double y : {window.y, window.y + window.height}) {
      const double left = x == window.x ? x - kGap_mm - kLength_mm : x + kGap_mm;
      const double bottom = y == window.y ? y - kGap_mm - kLength_mm : y + kGap_mm;
      black.push_back({left, y - 0.5 * kThin_mm, kLength_mm, kThin_mm});
      black.push_back({x - 0.5 * kThin_mm, bottom, kThin_mm, kLength_mm});
    }
  }
}

/// @param from the part of the page; its place on the tile is the tile's middle.
PrintedPage tileOf(const PrintedPage& page, const Paper& paper, const PrintedRectangle& from) {
  PrintedPage tile;
  tile.width_mm = paper.width_mm;
  tile.height_mm = paper.height_mm;
  const Eigen::Vector2d shift(kPaperMargin_mm - from.x, kPaperMargin_mm - from.y);
  tile.origin_mm = page.origin_mm + shift;
  for (const PrintedRectangle& whole : page.black) {
    PrintedRectangle part = clipped(whole, from);
    if (part.width <= 0.0 || part.height <= 0.0) continue;
    part.x += shift.x();
    part.y += shift.y();
    tile.black.push_back(part);
  }
  for (PrintedText text : page.texts) {
    if (text.x < from.x || text.x >= from.x + from.width || text.y < from.y || text.y >= from.y + from.height)
      continue;
    text.x += shift.x();
    text.y += shift.y();
    tile.texts.push_back(text);
  }
  addCutMarks(tile.black, {from.x + shift.x(), from.y + shift.y(), from.width, from.height});
  return tile;
}

}  // namespace

Paper paperNamed(const std::string& name) {
  static const std::array<Paper, 4> kPapers{
      {{"A4", 297.0, 210.0}, {"A3", 420.0, 297.0}, {"A2", 594.0, 420.0}, {"A1", 841.0, 594.0}}};
  const auto found =
      std::find_if(kPapers.begin(), kPapers.end(), [&](const Paper& paper) { return paper.name == name; });
  if (found == kPapers.end()) throw ConfigError({"paper " + name + " (must be A4, A3, A2 or A1)"});
  return *found;
}

double largestSquare_mm(const BoardSpec& board, const Paper& paper) {
  const Eigen::Vector2d room = roomFor(paper);
  const double square = std::floor(std::min(room.x() / board.columns, room.y() / board.rows));
  if (square < kSmallestSquare_mm) {
    throw ConfigError({"board of " + std::to_string(board.columns) + "x" + std::to_string(board.rows) +
                       " squares on " + paper.name + " (squares would be smaller than " +
                       inMm(kSmallestSquare_mm) + " mm: take larger paper or fewer squares)"});
  }
  return square;
}

PrintedPage drawBoard(const BoardSpec& board, const Paper& paper) {
  const Eigen::Vector2d square = 1000.0 * board.square_m;
  const Eigen::Vector2d size(board.columns * square.x(), board.rows * square.y());
  const Eigen::Vector2d room = roomFor(paper);
  if (size.x() > room.x() + 1e-9 || size.y() > room.y() + 1e-9) {
    throw ConfigError({"board of " + inMm(size.x()) + " x " + inMm(size.y()) + " mm on " + paper.name +
                       " (at most " + inMm(room.x()) + " x " + inMm(room.y()) +
                       " mm beside margins and rulers)"});
  }
  PrintedPage page;
  page.width_mm = paper.width_mm;
  page.height_mm = paper.height_mm;
  page.origin_mm = Eigen::Vector2d::Constant(kPaperMargin_mm + kRulerRoom_mm) + 0.5 * (room - size);
  addSquares(page, board, square);
  addRulers(page);
  addTexts(page, board, square);
  return page;
}

std::vector<PrintedPage> tilePage(const PrintedPage& page, const Paper& tile) {
  const double width = tile.width_mm - 2 * kPaperMargin_mm;
  const double height = tile.height_mm - 2 * kPaperMargin_mm;
  const int columns = static_cast<int>(std::ceil(page.width_mm / width));
  const int rows = static_cast<int>(std::ceil(page.height_mm / height));
  std::vector<PrintedPage> tiles;
  for (int row = rows - 1; row >= 0; --row) {
    for (int column = 0; column < columns; ++column) {
      PrintedPage part = tileOf(page, tile, {column * width, row * height, width, height});
      std::ostringstream text;
      text << "row " << rows - row << " of " << rows << ", column " << column + 1 << " of " << columns
           << ": cut along the marks, glue edge to edge";
      part.texts.push_back({kPaperMargin_mm + 10.0, 4.0, 2.5, text.str(), false});
      tiles.push_back(std::move(part));
    }
  }
  return tiles;
}

}  // namespace vismem
