#include "evaluation/core/truth_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/config/text_format.h"

namespace vismem {
namespace {

constexpr std::array<std::string_view, 4> kColumns{"t_s", "x_m", "y_m", "theta_rad"};
constexpr const char* kExpected = "expected numbers t_s,x_m,y_m,theta_rad, later than the line before";

std::vector<std::string_view> cellsOf(std::string_view line) {
  std::vector<std::string_view> cells = splitAt(line, ',');
  for (std::string_view& cell : cells) cell = trimmed(cell);
  return cells;
}

/// Where the four columns stand; filled by the header.
struct Columns {
  std::array<std::size_t, 4> at{0, 1, 2, 3};

  /// @return empty, or the names that are missing.
  std::string read(const std::vector<std::string_view>& header) {
    std::vector<std::string_view> missing;
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const auto found = std::find(header.begin(), header.end(), kColumns[i]);
      if (found == header.end()) missing.push_back(kColumns[i]);
      at[i] = static_cast<std::size_t>(found - header.begin());
    }
    return joined(missing, ", ");
  }

  std::optional<std::array<double, 4>> valuesOf(const std::vector<std::string_view>& cells) const {
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto value = at[i] < cells.size() ? finiteNumber(cells[at[i]]) : std::nullopt;
      if (!value) return std::nullopt;
      values[i] = *value;
    }
    return values;
  }
};

bool isHeader(const std::vector<std::string_view>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](std::string_view cell) {
    return std::find(kColumns.begin(), kColumns.end(), cell) != kColumns.end();
  });
}

}  // namespace

Trajectory parseTruth(std::string_view text, const std::string& file_name) {
  Trajectory truth;
  std::vector<std::string> problems;
  Columns columns;
  bool any_line = false;
  int number = 0;
  for (const std::string_view row : splitAt(text, '\n')) {
    ++number;
    const std::string_view line = trimmed(row);
    if (line.empty() || line.front() == '#') continue;
    const std::string where = file_name + ":" + std::to_string(number) + ": ";
    const auto cells = cellsOf(line);
    if (!std::exchange(any_line, true) && isHeader(cells)) {
      const std::string missing = columns.read(cells);
      if (!missing.empty())
        throw ConfigError({where + "\"" + std::string(line) + "\" lacks the columns " + missing});
      continue;
    }
    const auto values = columns.valuesOf(cells);
    if (!values || !append(truth, {toStampUs((*values)[0]), {(*values)[1], (*values)[2], (*values)[3]}}))
      problems.push_back(where + "\"" + std::string(line) + "\" (" + kExpected + ")");
  }
  if (problems.empty() && truth.size() < 2) {
    problems.push_back(file_name + ": " + std::to_string(truth.size()) + " poses (expected at least two)");
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return truth;
}

}  // namespace vismem
