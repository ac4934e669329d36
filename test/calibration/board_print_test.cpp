// The printed board, as Poppler renders it and libapriltag reads it.
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/core/target/board_drawing.h"
#include "calibration/core/target/board_file.h"
#include "calibration/core/target/pdf.h"
#include "common/config/config_error.h"
#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kDpi = 150;
constexpr double kPixelsPerMm = kDpi / 25.4;
/// Pages are A4, landscape; Poppler begins at their upper border and rounds the number of rows up.
constexpr double kHeight_mm = 210.0;

/// Pages of a PDF as grey images.
std::vector<cv::Mat> rendered(const std::string& pdf, const TemporaryFolder& folder) {
  ChildProcess poppler({"pdftoppm", "-gray", "-r", std::to_string(kDpi), pdf, folder / "page"});
  EXPECT_EQ(poppler.waitForExit(60s), 0) << poppler.error();
  EXPECT_EQ(poppler.error(), "");
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().extension() == ".pgm") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<cv::Mat> pages;
  for (const auto& file : files) pages.push_back(cv::imread(file, cv::IMREAD_GRAYSCALE));
  return pages;
}

/// Centre [mm from the lower left corner] of every tag in a page.
std::map<int, Eigen::Vector2d> tagsIn(const cv::Mat& page) {
  image_u8_t image{page.cols, page.rows, static_cast<int>(page.step), page.data};
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  zarray_t* found = apriltag_detector_detect(detector, &image);
  std::map<int, Eigen::Vector2d> centres;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(found, i, &tag);
    EXPECT_EQ(tag->hamming, 0);
    centres[tag->id] = Eigen::Vector2d(tag->c[0] / kPixelsPerMm, kHeight_mm - tag->c[1] / kPixelsPerMm);
  }
  apriltag_detections_destroy(found);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return centres;
}

/// Centre of a square on the sheet [mm].
Eigen::Vector2d centreOf(const BoardSpec& board, const PrintedPage& page, int tag) {
  const Eigen::Vector2d square = board.squareOf(tag).cast<double>() + Eigen::Vector2d(0.5, 0.5);
  return page.origin_mm + 1e3 * square.cwiseProduct(board.square_m);
}

void write(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(BoardPrint, EveryTagOfThePdfDecodesAtItsPlaceInTrueSize) {
  const TemporaryFolder folder;
  BoardSpec board;
  board.first_tag = 30;
  const Paper paper = paperNamed("A4");
  board.square_m.setConstant(1e-3 * largestSquare_mm(board, paper));
  const PrintedPage page = drawBoard(board, paper);
  write(folder / "board.pdf", writePdf({page}, "Board (test)"));
  const auto pages = rendered(folder / "board.pdf", folder);
  ASSERT_EQ(pages.size(), 1u);
  // 297 mm at 150 dots an inch: 1754 px.
  EXPECT_NEAR(pages[0].cols, 297 * kPixelsPerMm, 1.0);
  const auto tags = tagsIn(pages[0]);
  ASSERT_EQ(tags.size(), static_cast<std::size_t>(board.tags()));
  for (const auto& [id, centre] : tags) {
    EXPECT_LT((centre - centreOf(board, page, id)).norm(), 0.2) << "tag " << id;
  }
}

// The ruler's line is black over 100 mm and white beyond.
TEST(BoardPrint, RulersHave100Millimetres) {
  const TemporaryFolder folder;
  BoardSpec board;
  const PrintedPage page = drawBoard(board, paperNamed("A4"));
  write(folder / "board.pdf", writePdf({page}, "Board"));
  const cv::Mat image = rendered(folder / "board.pdf", folder).at(0);
  const auto darkLength = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& way) {
    // From the middle of the ruler in both directions, until it is white.
    const Eigen::Vector2d middle = from + 50.0 * way;
    double length = 0.0;
    for (const double sign : {-1.0, 1.0}) {
      for (double step = 0.0;; step += 0.05) {
        const Eigen::Vector2d at = kPixelsPerMm * (middle + sign * step * way);
        if (image.at<unsigned char>(static_cast<int>(kHeight_mm * kPixelsPerMm - at.y()),
                                    static_cast<int>(at.x())) > 240)
          break;
        length += 0.05;
      }
    }
    return length;
  };
  EXPECT_NEAR(darkLength(page.origin_mm - Eigen::Vector2d(0, 4.12), {1, 0}), 100.0, 0.3);
  EXPECT_NEAR(darkLength(page.origin_mm - Eigen::Vector2d(4.12, 0), {0, 1}), 100.0, 0.3);
}

TEST(BoardPrint, TilesTogetherHoldTheWholeBoard) {
  BoardSpec board;
  const Paper large = paperNamed("A3");
  board.square_m.setConstant(1e-3 * largestSquare_mm(board, large));
  const PrintedPage page = drawBoard(board, large);
  const auto tiles = tilePage(page, paperNamed("A4"));
  // 420 x 297 mm in parts of 273 x 186 mm.
  ASSERT_EQ(tiles.size(), 4u);
  const auto area = [](const PrintedPage& p) {
    double sum = 0.0;
    for (const auto& r : p.black) sum += r.width * r.height;
    return sum;
  };
  double sum = 0.0;
  for (const auto& tile : tiles) {
    sum += area(tile);
    for (const auto& r : tile.black) {
      EXPECT_GE(r.x, 0.0);
      EXPECT_LE(r.x + r.width, 297.0);
      EXPECT_GE(r.y, 0.0);
      EXPECT_LE(r.y + r.height, 210.0);
    }
  }
  // Eight cut marks a tile of 6 x 0.25 mm.
  EXPECT_NEAR(sum - 4 * 8 * 6 * 0.25, area(page), 1e-6);
  // A tag of the upper right part is at its place there. The part begins at 273, 186 mm.
  const TemporaryFolder folder;
  write(folder / "tiles.pdf", writePdf(tiles, "Tiles"));
  const auto pages = rendered(folder / "tiles.pdf", folder);
  ASSERT_EQ(pages.size(), 4u);
  const int last = board.first_tag + board.tags() - 1;
  const auto tags = tagsIn(pages[1]);
  ASSERT_TRUE(tags.contains(last));
  const Eigen::Vector2d expected = centreOf(board, page, last) - Eigen::Vector2d(273.0, 186.0) +
                                   Eigen::Vector2d::Constant(kPaperMargin_mm);
  EXPECT_LT((tags.at(last) - expected).norm(), 0.2);
}

TEST(BoardPrint, WhatDoesNotFitIsRefusedWithItsSize) {
  const auto message = [](auto&& call) -> std::string {
    try {
      call();
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message([] { paperNamed("A5"); }), HasSubstr("paper A5 (must be A4, A3, A2 or A1)"));
  BoardSpec board;
  board.square_m.setConstant(0.05);
  EXPECT_THAT(message([&] { drawBoard(board, paperNamed("A4")); }), HasSubstr("board of 450 x 300 mm on A4"));
  board.columns = 80;
  EXPECT_THAT(message([&] { largestSquare_mm(board, paperNamed("A4")); }), HasSubstr("smaller than 5 mm"));
}

TEST(BoardFile, IsReadAsItWasWrittenAndScaledByItsRulers) {
  BoardFile board;
  board.nominal.columns = 11;
  board.nominal.first_tag = 7;
  board.nominal.square_m.setConstant(0.030);
  board.ruler_mm = Eigen::Vector2d(97.0, 99.5);
  const BoardFile again = parseBoardFile(writeBoardFile(board), "board.json");
  EXPECT_EQ(again.nominal, board.nominal);
  ASSERT_TRUE(again.ruler_mm);
  // Printed at 97 %: 30 mm become 29.1 mm; up 29.85 mm.
  EXPECT_NEAR(again.measured().square_m.x(), 0.0291, 1e-12);
  EXPECT_NEAR(again.measured().square_m.y(), 0.02985, 1e-12);
}

TEST(BoardFile, ProblemsNameFileKeyValueAndRule) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      parseBoardFile(text, "b.json");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("x1_m,y1_m"),
            "b.json: no JSON from byte 1 on (must be a board that calibrate target wrote)");
  EXPECT_THAT(message("[]"), HasSubstr("b.json: must be an object"));
  EXPECT_THAT(message(R"({"columns": 9, "rows": 6})"), HasSubstr("missing key \"square_mm\""));
  EXPECT_THAT(message(R"({"colums": 9})"), HasSubstr("did you mean \"columns\"?"));
  EXPECT_THAT(message(R"({"columns": 9.5, "rows": 6, "square_mm": 29})"),
              HasSubstr("columns = 9.5 (must be a whole"));
  EXPECT_THAT(message(R"({"columns": 9, "rows": 6, "square_mm": "29"})"),
              HasSubstr("square_mm = \"29\" (must be a"));
  EXPECT_THAT(message(R"({"columns": 9, "rows": 6, "square_mm": 29, "family": "tag16h5"})"),
              HasSubstr("must be \"tag36h11\""));
  EXPECT_THAT(message(R"({"columns": 9, "rows": 6, "square_mm": 29, "ruler_mm": [9.9, 9.9]})"),
              HasSubstr("b.json: ruler_mm = 9.9, 9.9 (must be 85..115 mm: was the page printed at 100 %?)"));
}

// calibrate target as a user runs it: print, then the ruler.
TEST(CalibrateTarget, WritesBoardAndNotesTheRuler) {
  const TemporaryFolder folder;
  const std::string program = std::string(VISMEM_BIN_DIR) + "/calibrate";
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {program, "target", "--out", folder / "board"});
    ChildProcess child(arguments);
    EXPECT_TRUE(child.waitForExit(60s));
    return std::pair(child.exitCode().value_or(-1), child.out() + child.error());
  };
  auto [code, text] = run({"--paper", "A3"});
  ASSERT_EQ(code, 0) << text;
  EXPECT_THAT(text, HasSubstr("at 100 %"));
  const auto read = [&] {
    std::ifstream file(folder / "board/board.json");
    return parseBoardFile({std::istreambuf_iterator<char>(file), {}}, "board.json");
  };
  EXPECT_FALSE(read().ruler_mm);
  std::tie(code, text) = run({"--ruler-mm", "99.2", "99.5"});
  ASSERT_EQ(code, 0) << text;
  EXPECT_EQ(read().ruler_mm.value(), Eigen::Vector2d(99.2, 99.5));
  std::tie(code, text) = run({"--ruler-mm", "9.92", "9.95"});
  EXPECT_EQ(code, 2);
  EXPECT_THAT(text, HasSubstr("--ruler-mm 9.92, 9.95 (must be 85..115 mm"));
  std::tie(code, text) = run({"--ruler-mm", "99.2"});  // of two rulers
  EXPECT_EQ(code, 2);
  EXPECT_THAT(text, HasSubstr("--ruler-mm"));
  std::tie(code, text) = run({"--paper", "Letter"});
  EXPECT_EQ(code, 2);
  EXPECT_THAT(text, HasSubstr("paper Letter"));
}

}  // namespace
}  // namespace vismem
