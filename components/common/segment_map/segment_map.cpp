#include "common/segment_map/segment_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/config/text_file.h"

namespace vismem {
namespace {

constexpr std::string_view kHeader = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label";
constexpr std::string_view kHeaderWithWidth = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,width_m";
constexpr std::array<std::string_view, 8> kColumns{"x1_m", "y1_m", "z1_m",  "x2_m",
                                                   "y2_m", "z2_m", "label", "width_m"};
constexpr std::size_t kLabelColumn = 6;
constexpr std::size_t kWidthColumn = 7;

struct Cell {
  std::string_view text;
  std::size_t column = 1;  // of its first character, counted from 1
};

Cell trimmedCell(Cell cell) {
  const std::string_view text = trimmed(cell.text);
  if (text.empty()) return {{}, cell.column};
  return {text, cell.column + static_cast<std::size_t>(text.data() - cell.text.data())};
}

std::vector<Cell> split(std::string_view line) {
  std::vector<Cell> cells;
  for (const std::string_view part : splitAt(line, ',')) {
    cells.push_back(trimmedCell({part, 1 + static_cast<std::size_t>(part.data() - line.data())}));
  }
  return cells;
}

std::optional<double> number(std::string_view text) {
  return finiteNumber(text.substr(text.starts_with('+') ? 1 : 0));
}

class Reader {
 public:
  explicit Reader(const std::string& file_name) : file_name_(file_name) {}

  SegmentMap read(std::string_view text) {
    if (const auto kind = kindOf(text); !kind.empty() && kind != kMapKind)
      throw ConfigError({file_name_ + ": is " + std::string(kind) + " (must be " + std::string(kMapKind) +
                         ", which begins with \"" + std::string(kHeader) + "\")"});
    map_.ends_inside_row = !text.empty() && text.back() != '\n';
    while (!text.empty() && has_header_) {
      ++line_;
      const auto end = std::min(text.find('\n'), text.size());
      readLine(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (columns_ == 0 && has_header_) {
      problems_.push_back(file_name_ + ": no header line, expected \"" + std::string(kHeader) +
                          "[,width_m]\"");
    } else if (map_.segments.empty() && problems_.empty()) {
      problems_.push_back(file_name_ + ": no segments");
    }
    if (!problems_.empty()) throw ConfigError(problems_);
    return std::move(map_);
  }

 private:
  void problem(std::size_t column, const std::string& what) {
    std::ostringstream out;
    out << file_name_ << ':' << line_ << ':' << column << ": " << what;
    problems_.push_back(out.str());
  }

  void readLine(std::string_view text) {
    text = text.substr(0, text.find('#'));
    const Cell whole = trimmedCell({text, 1});
    if (whole.text.empty()) return;
    if (columns_ == 0) {
      readHeader(whole);
    } else {
      readRow(split(text));
    }
  }

  void readHeader(const Cell& header) {
    columns_ = header.text == kHeader ? kLabelColumn + 1 : kColumns.size();
    if (header.text == kHeader || header.text == kHeaderWithWidth) return;
    has_header_ = false;
    problem(header.column, "header = \"" + std::string(header.text) + "\" (must be \"" +
                               std::string(kHeader) + "[,width_m]\")");
  }

  void readRow(const std::vector<Cell>& cells) {
    // The width may be left out row by row.
    if (cells.size() < kLabelColumn + 1 || cells.size() > columns_) {
      const std::string expected = columns_ == kColumns.size() ? "7 or 8" : "7";
      problem(1, std::to_string(cells.size()) + " columns (must be " + expected + ")");
      return;
    }
    const std::size_t problems_before = problems_.size();
    std::array<double, kColumns.size()> values{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i == kLabelColumn || (i == kWidthColumn && cells[i].text.empty())) continue;
      const auto value = number(cells[i].text);
      if (!value) {
        problem(cells[i].column, describe(i, cells[i]) + " (must be a finite number)");
      } else if (std::abs(*value) > kFarthest_m) {
        problem(cells[i].column, describe(i, cells[i]) + " (must be -100000..100000)");
      } else {
        values[i] = *value;
      }
    }
    const Cell& label = cells[kLabelColumn];
    if (!isName(label.text)) {
      problem(label.column,
              describe(kLabelColumn, label) + " (must be letters, digits and _, beginning with a letter)");
    } else if (label.text == kUnknownLabel) {
      problem(label.column,
              describe(kLabelColumn, label) + " (is reserved; a line of every label is \"any\")");
    }
    if (values[kWidthColumn] < 0.0) {
      problem(cells[kWidthColumn].column,
              describe(kWidthColumn, cells[kWidthColumn]) + " (must be 0 or more)");
    }
    if (problems_.size() != problems_before) return;
    MapSegment segment;
    segment.world.a = {values[0], values[1], values[2]};
    segment.world.b = {values[3], values[4], values[5]};
    segment.label = label.text;
    segment.width_m = values[kWidthColumn];
    segment.line = line_;
    if (segment.world.length() <= 0.0) {
      problem(cells[0].column, "both ends are the same point (a segment needs a length)");
      return;
    }
    if (segment.width_m > 0.0 && segment.world.floor().length() <= 0.0) {
      problem(cells[kWidthColumn].column, describe(kWidthColumn, cells[kWidthColumn]) +
                                              " (an upright segment has no width in plan view)");
      return;
    }
    map_.segments.push_back(std::move(segment));
  }

  static std::string describe(std::size_t column, const Cell& cell) {
    return std::string(kColumns[column]) + " = \"" + std::string(cell.text) + '"';
  }

  std::string file_name_;
  std::size_t line_ = 0;
  std::size_t columns_ = 0;  // 0: before the header line
  bool has_header_ = true;   // false: another one stands in its place, and what follows says nothing
  SegmentMap map_;
  std::vector<std::string> problems_;
};

/// Shortest text that parses to the same number.
std::string text(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value == 0.0 ? 0.0 : value);
  return {buffer.data(), result.ptr};
}

}  // namespace

Eigen::Vector2d SegmentMap::low() const {
  Eigen::Vector2d low = segments.front().world.a.head<2>();
  for (const auto& segment : segments) {
    low = low.cwiseMin(segment.world.a.head<2>()).cwiseMin(segment.world.b.head<2>());
  }
  return low;
}

Eigen::Vector2d SegmentMap::high() const {
  Eigen::Vector2d high = segments.front().world.a.head<2>();
  for (const auto& segment : segments) {
    high = high.cwiseMax(segment.world.a.head<2>()).cwiseMax(segment.world.b.head<2>());
  }
  return high;
}

SegmentMap parseSegmentMap(std::string_view text, const std::string& file_name) {
  return Reader(file_name).read(text);
}

SegmentMap loadSegmentMap(const std::filesystem::path& file) {
  return parseSegmentMap(readTextFile(file, "a map of labelled segments"), file.string());
}

void saveSegmentMap(const SegmentMap& map, const std::filesystem::path& file) {
  const bool with_width = std::any_of(map.segments.begin(), map.segments.end(),
                                      [](const auto& segment) { return segment.width_m > 0.0; });
  std::ofstream out(file);
  out << (with_width ? kHeaderWithWidth : kHeader) << '\n';
  for (const auto& segment : map.segments) {
    for (const auto* end : {&segment.world.a, &segment.world.b}) {
      out << text(end->x()) << ',' << text(end->y()) << ',' << text(end->z()) << ',';
    }
    out << segment.label;
    if (segment.width_m > 0.0) out << ',' << text(segment.width_m);
    out << '\n';
  }
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

SegmentMap expandStripes(const SegmentMap& map, const std::map<Label, Label>& stripe_edges) {
  SegmentMap edges;
  edges.segments.reserve(map.segments.size() * 2);
  for (const auto& segment : map.segments) {
    if (segment.width_m <= 0.0) {
      edges.segments.push_back(segment);
      continue;
    }
    const Eigen::Vector2d d = (segment.world.floor().b - segment.world.floor().a).normalized();
    const Eigen::Vector3d aside = 0.5 * segment.width_m * Eigen::Vector3d(-d.y(), d.x(), 0.0);
    const auto found = stripe_edges.find(segment.label);
    const Label& label = found == stripe_edges.end() ? segment.label : found->second;
    edges.segments.push_back({{segment.world.a + aside, segment.world.b + aside}, label, 0.0});
    edges.segments.push_back({{segment.world.a - aside, segment.world.b - aside}, label, 0.0});
  }
  return edges;
}

bool labelFitsMap(const Label& observed, const Label& map_label) {
  return observed != kUnknownLabel && (observed == map_label || map_label == kAnyLabel);
}

}  // namespace vismem
