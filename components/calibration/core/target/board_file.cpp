#include "calibration/core/target/board_file.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "calibration/core/target/board_drawing.h"
#include "common/config/config_error.h"
#include "common/config/nearest_name.h"

namespace vismem {
namespace {

using nlohmann::json;

constexpr const char* kFamily = "tag36h11";
/// A printer that is farther off than this was asked to scale the page.
constexpr double kMaxRulerError_mm = 15.0;

class BoardReader {
 public:
  BoardReader(const json& root, const std::string& file) : root_(root), file_(file) {}

  BoardFile read() const {
    if (!root_.is_object()) fail("must be an object with columns, rows, square_mm");
    static const std::set<std::string> kKeys{"columns", "rows",      "square_mm",
                                             "family",  "first_tag", "ruler_mm"};
    for (const auto& [key, value] : root_.items()) {
      if (!kKeys.contains(key)) fail("unknown key \"" + key + "\"" + suggestion(key, kKeys));
    }
    BoardFile board;
    board.nominal.columns = whole("columns");
    board.nominal.rows = whole("rows");
    board.nominal.first_tag = root_.contains("first_tag") ? whole("first_tag") : 0;
    board.nominal.square_m.setConstant(number(required("square_mm"), "square_mm") * 1e-3);
    if (root_.contains("family") && root_["family"] != kFamily) {
      fail("family = " + root_["family"].dump() + " (must be \"" + kFamily + "\")");
    }
    if (root_.contains("ruler_mm")) board.ruler_mm = ruler(root_["ruler_mm"]);
    if (const std::string problem = checkBoard(board.nominal); !problem.empty()) fail(problem);
    return board;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw ConfigError({file_ + ": " + why}); }

  const json& required(const std::string& key) const {
    if (!root_.contains(key)) fail("missing key \"" + key + "\"");
    return root_[key];
  }
  int whole(const std::string& key) const {
    const json& value = required(key);
    if (!value.is_number_integer() || value < -1'000'000 || value > 1'000'000)
      fail(key + " = " + value.dump() + " (must be a whole number)");
    return value.get<int>();
  }
  double number(const json& value, const std::string& key) const {
    if (!value.is_number()) fail(key + " = " + value.dump() + " (must be a number)");
    return value.get<double>();
  }
  Eigen::Vector2d ruler(const json& value) const {
    if (!value.is_array() || value.size() != 2)
      fail("ruler_mm = " + value.dump() + " (must be two numbers: across and up)");
    const Eigen::Vector2d ruler_mm(number(value[0], "ruler_mm"), number(value[1], "ruler_mm"));
    if (const std::string problem = checkRuler(ruler_mm); !problem.empty()) fail("ruler_mm = " + problem);
    return ruler_mm;
  }

  const json& root_;
  const std::string& file_;
};

}  // namespace

BoardSpec BoardFile::measured() const {
  BoardSpec board = nominal;
  if (ruler_mm) board.square_m = nominal.square_m.cwiseProduct(*ruler_mm / kRuler_mm);
  return board;
}

std::string checkRuler(const Eigen::Vector2d& ruler_mm) {
  if ((ruler_mm.array() - kRuler_mm).abs().maxCoeff() <= kMaxRulerError_mm) return {};
  std::ostringstream problem;
  problem << ruler_mm.x() << ", " << ruler_mm.y() << " (must be "
          << kRuler_mm - kMaxRulerError_mm << ".." << kRuler_mm + kMaxRulerError_mm
          << " mm: was the page printed at 100 %?)";
  return problem.str();
}

BoardFile parseBoardFile(const std::string& text, const std::string& file) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::parse_error& error) {
    throw ConfigError({file + ": no JSON from byte " + std::to_string(error.byte) +
                       " on (must be a board that calibrate target wrote)"});
  }
  return BoardReader(root, file).read();
}

std::string writeBoardFile(const BoardFile& board) {
  nlohmann::ordered_json root{{"columns", board.nominal.columns},
                              {"rows", board.nominal.rows},
                              {"square_mm", board.nominal.square_m.x() * 1e3},
                              {"family", kFamily},
                              {"first_tag", board.nominal.first_tag}};
  if (board.ruler_mm) root["ruler_mm"] = {board.ruler_mm->x(), board.ruler_mm->y()};
  return root.dump(2) + "\n";
}

}  // namespace vismem
