/// @file Colour classes and the names of their pairs. See V3. Pure but for loadPalette.
///
/// A palette is a text file, `#` begins a comment, one `key = value` a line:
///
///     class.grass = hue 70..170 saturation 25..100 value 8..100
///     class.line  = saturation 0..25 value 45..100
///     pair.stripe_edge = grass line
///     stripe.line = stripe_edge
///
/// `class.NAME`: a region of colours; hue in degrees 0..360 (340..20 wraps over red), saturation and value in
/// per cent; a part left out is the whole range; a colour belongs to the first class of the file that has it.
/// Several lines of one name are regions of one class. `pair.LABEL`: the label of an edge between two classes,
/// in either order; a label may have several pairs. `stripe.NAME`: rows of a map called NAME with a width are
/// stripes; both their edges have that label.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/vision/image_segment.h"

namespace vismem {

/// Index of a colour class in the order of the file, from 1 on; 0 is no class.
using ColorClass = std::uint8_t;
constexpr ColorClass kNoColorClass = 0;

/// Interval of a colour space. `low > high` is allowed for hue only: the interval wraps.
struct ColorRange {
  double low = 0.0;
  double high = 0.0;
};

struct ColorClassDefinition {
  std::string name;
  ColorRange hue_deg{0.0, 360.0};
  ColorRange saturation_percent{0.0, 100.0};
  ColorRange value_percent{0.0, 100.0};
  int line = 0;  ///< of the file
};

/// A colour as palettes describe it.
struct ColorValues {
  double hue_deg = 0.0;  ///< 0 without a hue
  double saturation_percent = 0.0;
  double value_percent = 0.0;
  bool has_hue = false;  ///< false for pure greys
};
/// @param red, green, blue 0..255
ColorValues colorValues(double red, double green, double blue);

/// Immutable after construction: *thread-safe*. Holds a table of 1 MB, and 64 bytes for each of its cells
/// that a border between classes crosses.
class Palette {
 public:
  /// @param text the file's content.
  /// @param file_name is used in messages only.
  /// @throws ConfigError with every problem: file, line, key, value, rule.
  static Palette parse(std::string_view text, const std::string& file_name);

  /// Class of a colour, exactly, by table.
  ColorClass classOf(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const {
    const std::uint32_t cell = cells_[(red >> 2) << 12 | (green >> 2) << 6 | blue >> 2];
    if (cell < kFirstBlock) return static_cast<ColorClass>(cell);
    return blocks_[(cell - kFirstBlock) * 64U + ((red & 3) << 4 | (green & 3) << 2 | (blue & 3))];
  }
  /// Every class that contains a colour, in the order of the file: classOf gives the first one.
  std::vector<ColorClass> allClassesOf(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const;
  /// Classes that no colour gets, one line each with file, line and reason.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Classes are numbered 1..classCount(); every region of a class of several has a number of its own.
  int classCount() const { return static_cast<int>(classes_.size()); }
  const ColorClassDefinition& definition(ColorClass color_class) const {
    return classes_.at(color_class - 1U);
  }
  /// "none" for no class.
  const std::string& className(ColorClass color_class) const;
  /// @return the class (its first region) of that name, or kNoColorClass.
  ColorClass classNamed(std::string_view name) const;

  /// Label of an edge between two classes (either order); kUnknownLabel where no pair names it.
  const Label& label(ColorClass a, ColorClass b) const { return labels_[a * (classes_.size() + 1) + b]; }
  /// Every label that an edge can get (without kUnknownLabel), sorted.
  std::vector<Label> labels() const;
  /// Labels none of whose edges borders the class `floor`: edges that stand up, as door jambs do. Empty
  /// without such a class.
  std::optional<std::set<Label>> labelsOffFloor() const;
  /// Name of a stripe in maps -> label of its edges.
  const std::map<Label, Label>& stripes() const { return stripes_; }

 private:
  static constexpr std::uint32_t kFirstBlock = 256;

  Palette() = default;
  ColorClass firstMatch(const ColorValues& values) const;
  void buildTable();
  void findUnusedClasses(const std::string& file_name);

  std::vector<ColorClassDefinition> classes_;
  std::vector<Label> labels_;  // square, (classes + 1)^2
  std::map<Label, Label> stripes_;
  /// Of 64^3 cells of 4x4x4 colours: their class, or from kFirstBlock on the index of their block.
  std::vector<std::uint32_t> cells_;
  std::vector<ColorClass> blocks_;  // 64 each: the classes of the colours of a cell
  std::vector<std::string> warnings_;
};

/// Reads a palette.
/// @throws ConfigError as Palette::parse, also when the file cannot be read.
Palette loadPalette(const std::filesystem::path& file);

}  // namespace vismem
