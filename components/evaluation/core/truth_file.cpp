#include "evaluation/core/truth_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/config/config_error.h"

namespace vismem {
namespace {

constexpr std::array<std::string_view, 4> kColumns{"t_s", "x_m", "y_m", "theta_rad"};
constexpr const char* kExpected = "expected numbers t_s,x_m,y_m,theta_rad, later than the line before";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string_view> cellsOf(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = std::min(line.find(','), line.size());
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == line.size()) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> cellValue(std::string_view cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Where the four columns stand; filled by the header.
struct Columns {
  std::array<std::size_t, 4> at{0, 1, 2, 3};

  /// @return empty, or the names that are missing.
  std::string read(const std::vector<std::string_view>& header) {
    std::string missing;
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const auto found = std::find(header.begin(), header.end(), kColumns[i]);
      if (found == header.end()) missing += (missing.empty() ? "" : ", ") + std::string(kColumns[i]);
      at[i] = static_cast<std::size_t>(found - header.begin());
    }
    return missing;
  }

  std::optional<std::array<double, 4>> valuesOf(const std::vector<std::string_view>& cells) const {
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto value = at[i] < cells.size() ? cellValue(cells[at[i]]) : std::nullopt;
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
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
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
