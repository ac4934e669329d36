#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "calibration/app/board_world.h"
#include "calibration/app/commands.h"
#include "calibration/app/output_files.h"
#include "calibration/core/target/board_drawing.h"
#include "calibration/core/target/board_file.h"
#include "calibration/core/target/pdf.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"

namespace vismem {
namespace {

struct TargetOptions {
  std::filesystem::path out;
  std::string paper = "A4";
  std::string tile;
  BoardSpec board;
  double square_mm = 0.0;
  std::vector<double> ruler_mm;
  bool is_for_simulator = false;
};

void printSummary(const BoardFile& board, const std::filesystem::path& file, std::size_t pages) {
  const Eigen::Vector2d square_mm = 1e3 * board.measured().square_m;
  nlohmann::json summary{{"board", file.string()},
                         {"columns", board.nominal.columns},
                         {"rows", board.nominal.rows},
                         {"square_mm", {square_mm.x(), square_mm.y()}},
                         {"measured", board.ruler_mm.has_value()}};
  if (pages > 0) summary["pages"] = pages;
  std::cout << summary.dump() << std::endl;
}

/// The rulers of a board that is printed already.
int enterRuler(const TargetOptions& options, const std::filesystem::path& file) {
  BoardFile board = parseBoardFile(readTextFile(file, "a board that calibrate target wrote"), file.string());
  board.ruler_mm = Eigen::Vector2d(options.ruler_mm.front(), options.ruler_mm.back());
  if (const std::string problem = checkRuler(*board.ruler_mm); !problem.empty())
    throw ConfigError({"--ruler-mm " + problem});
  writeWholeFile(file, writeBoardFile(board));
  std::cout << "Noted. All parts of calibrate that read " << file.string() << " use it.\n";
  printSummary(board, file, 0);
  return 0;
}

int printBoard(TargetOptions options, const std::filesystem::path& file) {
  const Paper paper = paperNamed(options.paper);
  // Whatever the square is, the rest of the board must be possible.
  if (const std::string problem = checkBoard(options.board); !problem.empty()) throw ConfigError({problem});
  const double square_mm =
      options.square_mm > 0.0 ? options.square_mm : largestSquare_mm(options.board, paper);
  options.board.square_m.setConstant(1e-3 * square_mm);
  const PrintedPage page = drawBoard(options.board, paper);
  const std::vector<PrintedPage> pages =
      options.tile.empty() ? std::vector<PrintedPage>{page} : tilePage(page, paperNamed(options.tile));
  const std::filesystem::path pdf = options.out / "board.pdf";
  writeWholeFile(pdf, writePdf(pages, "Calibration board"));
  writeWholeFile(file, writeBoardFile({options.board, std::nullopt}));
  if (options.is_for_simulator) {
    std::cout << "A world with the board: " << writeBoardWorld(options.board, options.out).string() << "\n";
  }
  std::cout << "Print " << pdf.string()
            << " at 100 % (not \"fit to page\") and glue it flat onto something stiff.\n"
            << "Measure both rulers and type what they measure:\n  calibrate target --out "
            << options.out.string() << " --ruler-mm ACROSS UP\n";
  printSummary({options.board, std::nullopt}, file, pages.size());
  return 0;
}

}  // namespace

CalibrateCommand addTargetCommand(CLI::App& calibrate) {
  auto options = std::make_shared<TargetOptions>();
  CLI::App* app = calibrate.add_subcommand(
      "target",
      "Writes the calibration board: OUT/board.pdf to print and OUT/board.json, which the other parts read. "
      "With "
      "--ruler-mm it only notes what the printed rulers measure. The last line is JSON.");
  app->add_option("--out", options->out, "folder for the board")->required();
  app->add_option("--paper", options->paper, "A4, A3, A2 or A1, landscape")->capture_default_str();
  app->add_option("--tile", options->tile, "print it in parts on this paper: A4 or A3");
  app->add_option("--columns", options->board.columns, "squares across")->capture_default_str();
  app->add_option("--rows", options->board.rows, "squares up")->capture_default_str();
  app->add_option("--square-mm", options->square_mm, "side of a square [mm]; default: as large as fits")
      ->check(CLI::Range(5.0, 500.0));
  app->add_option("--first-tag", options->board.first_tag, "first tag, for several boards in one room")
      ->capture_default_str();
  app->add_option("--ruler-mm", options->ruler_mm, "ACROSS UP: what the two rulers of 100 mm measure [mm]")
      ->expected(2);
  app->add_flag("--world", options->is_for_simulator,
                "also OUT/board.world: the board on a floor, for the simulator");
  return {app, [options] {
            const std::filesystem::path file = options->out / "board.json";
            return options->ruler_mm.empty() ? printBoard(*options, file) : enterRuler(*options, file);
          }};
}

}  // namespace vismem
