/// @file lens_series: many drawn lenses through `calibrate lens`, beside mrcal on the same corners. See its
/// --help.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/tool/command_line_tool.h"
#include "support/lens_trials.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

constexpr double kGoal_px = 0.3;

using Row = std::map<std::string, double>;
const std::vector<std::string> kColumns{"seed",     "view_deg", "k1",     "images", "views",   "enough",
                                        "model",    "worst_px", "fixed",  "ratio",  "squares", "variance",
                                        "sigma_px", "halves",   "mrcal4", "mrcal5"};

/// mrcal's worst error; NaN without it.
double worstOfMrcal(const LensTrial& trial, const std::string& model) {
  const TemporaryFolder folder;
  BoardSpec board;
  board.square_m.setConstant(0.029);
  const auto lens = lensOfMrcal(trial, board, folder.path(), model);
  if (!lens) return std::nan("");
  return projectionDifference(trial.truth, *lens, pixelGrid(trial.truth.width, trial.truth.height, 17, 13))
      .worst_px;
}

Row rowOf(const LensTrial& trial) {
  Row row;
  for (const std::string& column : kColumns) row[column] = std::nan("");
  row["seed"] = trial.seed;
  row["view_deg"] = trial.view_deg;
  row["k1"] = trial.truth.k1;
  row["images"] = trial.images;
  row["views"] = static_cast<double>(trial.views.size());
  row["enough"] = trial.is_enough;
  if (!trial.problem.empty()) {
    std::cerr << "seed " << trial.seed << ": " << trial.problem << "\n";
    return row;
  }
  const LensCalibration& found = trial.calibration;
  row["model"] = static_cast<double>(found.fit.model);
  row["worst_px"] = trial.worst_px;
  row["fixed"] = trial.worst_fixed_px;
  row["ratio"] = found.heldOutRatio();
  row["squares"] = trial.squares;
  row["variance"] = trial.variance;
  row["sigma_px"] = found.uncertainty.sigma_px[found.uncertainty.worst];
  row["halves"] = found.halves ? found.halves->worst_px : std::nan("");
  row["mrcal4"] = worstOfMrcal(trial, "LENSMODEL_OPENCV4");
  row["mrcal5"] = worstOfMrcal(trial, "LENSMODEL_OPENCV5");
  return row;
}

std::map<unsigned, Row> readRows(const std::filesystem::path& file) {
  std::map<unsigned, Row> rows;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    Row row;
    std::string field;
    for (const std::string& column : kColumns) {
      if (!std::getline(fields, field, ',')) break;
      row[column] = std::stod(field);
    }
    if (row.size() == kColumns.size()) rows[static_cast<unsigned>(row["seed"])] = row;
  }
  return rows;
}

void appendRow(const std::filesystem::path& file, const Row& row) {
  const bool is_new = !std::filesystem::exists(file);
  std::ofstream stream(file, std::ios::app);
  const auto write = [&](auto&& text) {
    for (std::size_t i = 0; i < kColumns.size(); ++i) stream << (i ? "," : "") << text(kColumns[i]);
    stream << "\n";
  };
  if (is_new) write([](const std::string& column) { return column; });
  write([&](const std::string& column) { return row.at(column); });
  if (!stream.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

void printTable(const std::map<unsigned, Row>& rows) {
  for (const std::string& column : kColumns) std::cout << std::setw(9) << column;
  std::cout << "\n" << std::setprecision(3);
  for (const auto& [seed, row] : rows) {
    for (const std::string& column : kColumns) std::cout << std::setw(9) << row.at(column);
    std::cout << "\n";
  }
}

/// Our worst errors beside those of one model of mrcal, over the lenses that both solved.
nlohmann::json comparisonWith(const std::string& model, const std::map<unsigned, Row>& rows) {
  int compared = 0;
  int not_worse = 0;
  double sum_ours = 0.0;
  double sum_mrcal = 0.0;
  for (const auto& [seed, row] : rows) {
    const double ours = row.at("worst_px");
    const double mrcal = row.at(model);
    if (std::isnan(mrcal) || std::isnan(ours)) continue;
    ++compared;
    not_worse += ours <= mrcal;
    sum_ours += ours;
    sum_mrcal += mrcal;
  }
  if (compared == 0) return nullptr;
  return {{"lenses", compared},
          {"not_worse", not_worse},
          {"mean_worst_px", sum_ours / compared},
          {"mean_worst_mrcal_px", sum_mrcal / compared},
          {"is_good", sum_ours <= sum_mrcal}};
}

/// @return whether all goals are met.
bool summarise(const std::map<unsigned, Row>& rows) {
  int good = 0;
  double worst = 0.0;
  double ratio = 0.0;
  double squares = 0.0;
  double variance = 0.0;
  for (const auto& [seed, row] : rows) {
    good += row.at("worst_px") <= kGoal_px;
    worst = std::max(worst, std::isnan(row.at("worst_px")) ? INFINITY : row.at("worst_px"));
    ratio = std::max(ratio, row.at("ratio"));
    if (std::isnan(row.at("squares"))) continue;
    squares += row.at("squares");
    variance += row.at("variance");
  }
  const double normalised = std::sqrt(squares / variance);
  nlohmann::json summary{{"lenses", rows.size()},
                         {"within_goal", good},
                         {"worst_px", worst},
                         {"worst_held_out_ratio", ratio},
                         {"normalised_error", normalised}};
  bool is_good = good == static_cast<int>(rows.size()) && ratio <= kMaxHeldOutRatio && normalised >= 0.7 &&
                 normalised <= 1.5;
  for (const std::string model : {"mrcal4", "mrcal5"}) {
    summary[model] = comparisonWith(model, rows);
    if (!summary[model].is_null()) is_good &= summary[model]["is_good"].get<bool>();
  }
  std::cout << summary.dump() << std::endl;
  return is_good;
}

}  // namespace
}  // namespace vismem

int main(int argc, char** argv) {
  using namespace vismem;
  CLI::App app(
      "Calibrates lenses drawn by seed from rendered images of a board, and compares with the truth and with "
      "mrcal (Debian "
      "package mrcal; columns mrcal4 and mrcal5 are its OPENCV4 and OPENCV5; nan without it). Errors are of "
      "the projection over "
      "the image, at "
      "worst, a turn of the "
      "camera taken out (column fixed: not taken out). Lenses that the table has already are skipped. Exit "
      "code 1: a goal is "
      "missed.",
      "lens_series");
  std::filesystem::path table;
  unsigned first = 1;
  unsigned lenses = 20;
  app.add_option("--table", table, "CSV file, continued when it exists")->required();
  app.add_option("--first", first, "first seed")->capture_default_str();
  app.add_option("--lenses", lenses, "number of lenses")->capture_default_str();
  if (const auto code = parseTool(app, argc, argv)) return *code;
  auto rows = readRows(table);
  for (unsigned seed = first; seed < first + lenses; ++seed) {
    if (rows.contains(seed)) continue;
    rows[seed] = rowOf(tryLens(seed));
    appendRow(table, rows[seed]);
    std::cerr << "seed " << seed << ": " << rows[seed]["worst_px"] << " px\n";
  }
  printTable(rows);
  return summarise(rows) ? 0 : 1;
}
