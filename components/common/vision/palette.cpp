#include "common/vision/palette.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/config/text_file.h"
#include "common/config/text_format.h"

namespace vismem {
namespace {

constexpr int kCells = 64;  // of the table, per channel
constexpr int kSide = 4;    // levels of a channel in a cell
constexpr std::size_t kMaxClasses = 64;

/// "LO..HI"; the dots are found first, because "340." would be a number too.
std::optional<ColorRange> range(std::string_view text) {
  const auto dots = text.find("..");
  if (dots == std::string_view::npos) return std::nullopt;
  const auto low = finiteNumber(text.substr(0, dots));
  const auto high = finiteNumber(text.substr(dots + 2));
  if (!low || !high) return std::nullopt;
  return ColorRange{*low, *high};
}

bool inside(double value, const ColorRange& range) {
  return value >= range.low && value <= range.high;
}

bool matches(const ColorClassDefinition& definition, const ColorValues& hsv) {
  if (!inside(hsv.saturation_percent, definition.saturation_percent)) return false;
  if (!inside(hsv.value_percent, definition.value_percent)) return false;
  const ColorRange& hue = definition.hue_deg;
  // A pure grey has no hue: it belongs only to classes of all hues.
  if (!hsv.has_hue) return hue.low <= 0.0 && hue.high >= 360.0;
  if (hue.low <= hue.high) return inside(hsv.hue_deg, hue);
  return hsv.hue_deg >= hue.low || hsv.hue_deg <= hue.high;
}

/// Collects the lines of a file and their problems before anything is built.
class Reader {
 public:
  explicit Reader(const std::string& file_name) : file_name_(file_name) {}

  struct Pair {
    int line;
    std::string key, label, a, b;
  };
  struct Stripe {
    int line;
    std::string key, name, edge;
  };

  void read(std::string_view text) {
    int line_number = 0;
    while (!text.empty()) {
      ++line_number;
      const auto end = std::min(text.find('\n'), text.size());
      readLine(line_number, text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (classes.empty())
      problems.push_back(file_name_ + ": no class (at least one \"class.NAME\" is needed)");
  }

  void problem(int line, std::string_view key, std::string_view value, std::string_view rule) {
    std::ostringstream out;
    out << file_name_ << ':' << line << ": " << key << " = " << value << " (" << rule << ')';
    problems.push_back(out.str());
  }

  std::vector<ColorClassDefinition> classes;
  std::vector<Pair> pairs;
  std::vector<Stripe> stripes;
  std::vector<std::string> problems;

 private:
  void readLine(int line, std::string_view text) {
    text = contentOf(text);
    if (text.empty()) return;
    const auto equals = text.find('=');
    if (equals == std::string_view::npos) {
      problems.push_back(file_name_ + ':' + std::to_string(line) + ": \"" + std::string(text) +
                         "\" (must be KEY = VALUE)");
      return;
    }
    const std::string_view key = trimmed(text.substr(0, equals));
    const std::string_view value = trimmed(text.substr(equals + 1));
    const auto dot = key.find('.');
    const std::string_view kind = key.substr(0, dot);
    // Classes have regions, labels pairs, as many as they need; the same one twice is a mistake.
    const std::string once =
        kind == "stripe" ? std::string(key) : std::string(key) + '=' + std::string(value);
    const auto [first, is_new] = seen_.try_emplace(once, line);
    if (!is_new) {
      problem(line, key, value, "already given in line " + std::to_string(first->second));
      return;
    }
    if (dot == std::string_view::npos || (kind != "class" && kind != "pair" && kind != "stripe")) {
      problem(line, key, value, "unknown key, must be class.NAME, pair.LABEL or stripe.NAME");
      return;
    }
    const std::string_view name = key.substr(dot + 1);
    if (!isName(name)) {
      problem(line, key, value, "a name is letters, digits and _, and begins with a letter");
    } else if (kind == "class") {
      readClass(line, key, name, value);
    } else if (kind == "pair") {
      readPair(line, key, name, value);
    } else {
      const auto parts = words(value);
      if (parts.size() != 1) {
        problem(line, key, value, "must be one label");
      } else {
        stripes.push_back({line, std::string(key), std::string(name), std::string(parts[0])});
      }
    }
  }

  void readClass(int line, std::string_view key, std::string_view name, std::string_view value) {
    ColorClassDefinition definition;
    definition.name = name;
    definition.line = line;
    const auto parts = words(value);
    if (parts.empty() || parts.size() % 2 != 0) {
      problem(line, key, value, "must be: hue LO..HI saturation LO..HI value LO..HI");
      return;
    }
    std::set<std::string_view> given;
    for (std::size_t i = 0; i < parts.size(); i += 2) {
      ColorRange* target = parts[i] == "hue"          ? &definition.hue_deg
                           : parts[i] == "saturation" ? &definition.saturation_percent
                           : parts[i] == "value"      ? &definition.value_percent
                                                      : nullptr;
      const std::string part = std::string(parts[i]) + ' ' + std::string(parts[i + 1]);
      if (target == nullptr) {
        problem(line, key, part, "must be hue, saturation or value");
        continue;
      }
      if (!given.insert(parts[i]).second) problem(line, key, part, "given twice");
      const bool is_hue = target == &definition.hue_deg;
      const double limit = is_hue ? 360.0 : 100.0;
      const auto parsed = range(parts[i + 1]);
      if (!parsed) {
        problem(line, key, part, "must be LO..HI");
      } else if (parsed->low < 0.0 || parsed->low > limit || parsed->high < 0.0 || parsed->high > limit) {
        problem(line, key, part, is_hue ? "must be within 0..360 degrees" : "must be within 0..100 per cent");
      } else if (!is_hue && parsed->low > parsed->high) {
        problem(line, key, part, "LO must not be above HI");
      } else {
        *target = *parsed;
      }
    }
    if (classes.size() == kMaxClasses) {
      problem(line, key, value, "at most 64 classes");
      return;
    }
    classes.push_back(definition);  // also an invalid one, so that its pairs cause no further problems
  }

  void readPair(int line, std::string_view key, std::string_view name, std::string_view value) {
    if (name == kUnknownLabel || name == kAnyLabel) {
      problem(line, key, value, "\"" + std::string(name) + "\" is reserved");
      return;
    }
    const auto parts = words(value);
    if (parts.size() != 2) {
      problem(line, key, value, "must be two classes");
      return;
    }
    pairs.push_back(
        {line, std::string(key), std::string(name), std::string(parts[0]), std::string(parts[1])});
  }

  std::string file_name_;
  std::map<std::string, int> seen_;
};

/// Least and greatest values of the colours of a cell.
struct CellValues {
  ColorRange hue_deg;  ///< not wrapped: `high` may exceed 360, `low` be below 0
  bool has_all_hues = false;
  ColorRange saturation_percent;
  ColorRange value_percent;
};

/// Channel by channel hue turns one way only, so its extremes lie at corners of the cell.
CellValues valuesOfCell(const std::array<int, 3>& first) {
  const auto [low, high] = std::minmax({first[0], first[1], first[2]});
  CellValues cell;
  const double least_max = high;
  const double most_max = high + kSide - 1;
  cell.value_percent = {100.0 * least_max / 255.0, 100.0 * most_max / 255.0};
  cell.saturation_percent = {
      least_max > 0.0 ? 100.0 * std::max(0.0, 1.0 - (low + kSide - 1) / least_max) : 0.0,
      most_max > 0.0 ? 100.0 * (1.0 - low / most_max) : 0.0};
  cell.has_all_hues = high - low < kSide;  // holds greys
  if (cell.has_all_hues) return cell;
  const double middle = colorValues(first[0] + 1.5, first[1] + 1.5, first[2] + 1.5).hue_deg;
  cell.hue_deg = {middle, middle};
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](int i) { return first[i] + ((corner >> i) & 1) * (kSide - 1); };
    double off = colorValues(at(0), at(1), at(2)).hue_deg - middle;
    off -= 360.0 * std::round(off / 360.0);
    cell.hue_deg.low = std::min(cell.hue_deg.low, middle + off);
    cell.hue_deg.high = std::max(cell.hue_deg.high, middle + off);
  }
  return cell;
}

enum class Overlap { kNone, kPart, kWhole };

Overlap overlap(const ColorRange& cell, const ColorRange& range) {
  constexpr double kRounding = 1e-9;
  if (cell.high < range.low - kRounding || cell.low > range.high + kRounding) return Overlap::kNone;
  return inside(cell.low - kRounding, range) && inside(cell.high + kRounding, range) ? Overlap::kWhole
                                                                                     : Overlap::kPart;
}

/// Of a cell's hues, which may lie on either side of 0, with a range that may wrap.
Overlap overlapOfHues(const CellValues& cell, const ColorRange& hue) {
  if (hue.low <= 0.0 && hue.high >= 360.0) return Overlap::kWhole;
  if (cell.has_all_hues) return Overlap::kPart;
  const ColorRange whole{hue.low, hue.low <= hue.high ? hue.high : hue.high + 360.0};
  Overlap best = Overlap::kNone;
  for (const double turn : {-360.0, 0.0, 360.0}) {
    const ColorRange turned{cell.hue_deg.low + turn, cell.hue_deg.high + turn};
    best = std::max(best, overlap(turned, whole));
  }
  return best;
}

Overlap overlap(const CellValues& cell, const ColorClassDefinition& definition) {
  return std::min({overlap(cell.value_percent, definition.value_percent),
                   overlap(cell.saturation_percent, definition.saturation_percent),
                   overlapOfHues(cell, definition.hue_deg)});
}

/// Their class, if all colours of a cell have one.
std::optional<ColorClass> commonClass(const CellValues& cell,
                                      const std::vector<ColorClassDefinition>& classes) {
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const Overlap here = overlap(cell, classes[i]);
    if (here == Overlap::kPart) return std::nullopt;
    if (here == Overlap::kWhole) return static_cast<ColorClass>(i + 1);
  }
  return kNoColorClass;
}

}  // namespace

ColorValues colorValues(double r, double g, double b) {
  const double high = std::max({r, g, b});
  const double chroma = high - std::min({r, g, b});
  ColorValues hsv;
  hsv.value_percent = 100.0 * high / 255.0;
  if (chroma <= 0.0) return hsv;
  hsv.has_hue = true;
  hsv.saturation_percent = 100.0 * chroma / high;
  if (high == r) {
    hsv.hue_deg = 60.0 * (g - b) / chroma;
  } else if (high == g) {
    hsv.hue_deg = 60.0 * (b - r) / chroma + 120.0;
  } else {
    hsv.hue_deg = 60.0 * (r - g) / chroma + 240.0;
  }
  if (hsv.hue_deg < 0.0) hsv.hue_deg += 360.0;
  return hsv;
}

Palette Palette::parse(std::string_view text, const std::string& file_name) {
  if (const auto kind = kindOf(text); !kind.empty() && kind != kPaletteKind)
    throw ConfigError({file_name + ": is " + std::string(kind) + " (must be " + std::string(kPaletteKind) +
                       ": lines such as class.floor = value 40..80)"});
  Reader reader(file_name);
  reader.read(text);

  Palette palette;
  palette.classes_ = reader.classes;
  const std::size_t side = palette.classes_.size() + 1;
  palette.labels_.assign(side * side, kUnknownLabel);
  std::set<Label> edge_labels;
  for (const auto& pair : reader.pairs) {
    edge_labels.insert(pair.label);
    const std::string value = pair.a + ' ' + pair.b;
    const ColorClass a = palette.classNamed(pair.a);
    const ColorClass b = palette.classNamed(pair.b);
    if (a == kNoColorClass) reader.problem(pair.line, pair.key, value, "no class \"" + pair.a + '"');
    if (b == kNoColorClass) reader.problem(pair.line, pair.key, value, "no class \"" + pair.b + '"');
    if (a == kNoColorClass || b == kNoColorClass) continue;
    if (palette.labels_[a * side + b] != kUnknownLabel) {
      reader.problem(pair.line, pair.key, value,
                     "these classes already are \"" + palette.labels_[a * side + b] + '"');
      continue;
    }
    for (std::size_t i = 1; i < side; ++i) {
      for (std::size_t j = 1; j < side; ++j) {
        if (palette.classes_[i - 1].name != pair.a || palette.classes_[j - 1].name != pair.b) continue;
        palette.labels_[i * side + j] = pair.label;
        palette.labels_[j * side + i] = pair.label;
      }
    }
  }
  for (const auto& stripe : reader.stripes) {
    if (!edge_labels.contains(stripe.edge)) {
      reader.problem(stripe.line, stripe.key, stripe.edge, "no pair has that label");
    }
    palette.stripes_[stripe.name] = stripe.edge;
  }
  if (!reader.problems.empty()) throw ConfigError(reader.problems);
  palette.buildTable();
  palette.findUnusedClasses(file_name);
  return palette;
}

ColorClass Palette::firstMatch(const ColorValues& values) const {
  const auto found = std::find_if(classes_.begin(), classes_.end(),
                                  [&](const auto& definition) { return matches(definition, values); });
  return found == classes_.end() ? kNoColorClass : static_cast<ColorClass>(found - classes_.begin() + 1);
}

void Palette::buildTable() {
  cells_.reserve(static_cast<std::size_t>(kCells) * kCells * kCells);
  for (int red = 0; red < 256; red += kSide) {
    for (int green = 0; green < 256; green += kSide) {
      for (int blue = 0; blue < 256; blue += kSide) {
        if (const auto all = commonClass(valuesOfCell({red, green, blue}), classes_)) {
          cells_.push_back(*all);
          continue;
        }
        cells_.push_back(kFirstBlock + static_cast<std::uint32_t>(blocks_.size() / 64));
        for (int i = 0; i < 64; ++i) {
          blocks_.push_back(firstMatch(colorValues(red + (i >> 4), green + ((i >> 2) & 3), blue + (i & 3))));
        }
      }
    }
  }
}

std::vector<ColorClass> Palette::allClassesOf(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const {
  const ColorValues values = colorValues(red, green, blue);
  std::vector<ColorClass> found;
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    if (matches(classes_[i], values)) found.push_back(static_cast<ColorClass>(i + 1));
  }
  return found;
}

void Palette::findUnusedClasses(const std::string& file_name) {
  std::vector<bool> used(classes_.size() + 1, false);
  for (const std::uint32_t cell : cells_) {
    if (cell < kFirstBlock) used[cell] = true;
  }
  for (const ColorClass taken : blocks_) used[taken] = true;
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    if (used[i + 1]) continue;
    const ColorClassDefinition& unused = classes_[i];
    std::set<ColorClass> before;  // that have its colours, of which a part is tried
    for (int cell = 0; cell < kCells * kCells * kCells; ++cell) {
      const auto level = [cell](int shift) { return (cell >> shift) % kCells * 255 / (kCells - 1); };
      const ColorValues values = colorValues(level(12), level(6), level(0));
      if (matches(unused, values)) before.insert(firstMatch(values));
    }
    before.erase(kNoColorClass);
    const auto nameOf = [this](ColorClass taken) { return className(taken); };
    warnings_.push_back(file_name + ":" + std::to_string(unused.line) + ": class " + unused.name +
                        (before.empty() ? " holds no colour"
                                        : " gets no colour: before it come " + joined(before, ", ", nameOf)));
  }
}

const std::string& Palette::className(ColorClass color_class) const {
  static const std::string kNone = "none";
  return color_class == kNoColorClass ? kNone : classes_.at(color_class - 1U).name;
}

ColorClass Palette::classNamed(std::string_view name) const {
  const auto found =
      std::find_if(classes_.begin(), classes_.end(), [&](const auto& item) { return item.name == name; });
  return found == classes_.end() ? kNoColorClass : static_cast<ColorClass>(found - classes_.begin() + 1);
}

std::vector<Label> Palette::labels() const {
  std::set<Label> unique(labels_.begin(), labels_.end());
  unique.erase(kUnknownLabel);
  return {unique.begin(), unique.end()};
}

std::optional<std::set<Label>> Palette::labelsOffFloor() const {
  if (classNamed("floor") == kNoColorClass) return std::nullopt;
  const std::vector<Label> all = labels();
  std::set<Label> off(all.begin(), all.end());
  for (ColorClass a = 1; a <= classCount(); ++a) {
    for (ColorClass b = 1; b <= classCount(); ++b) {
      if (className(a) == "floor") off.erase(label(a, b));
    }
  }
  return off;
}

Palette loadPalette(const std::filesystem::path& file) {
  return Palette::parse(readTextFile(file, "a palette"), file.string());
}

}  // namespace vismem
