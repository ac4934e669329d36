/// @file Style syntax of SVG: colours, lengths, style sheets. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

using SvgColor = std::array<std::uint8_t, 3>;  ///< R G B

struct SvgPaint {
  std::optional<SvgColor> color;  ///< empty: not painted
  bool current = false;           ///< the element's `color`
  std::string reference;          ///< id of a gradient or pattern; color is then its fallback
};
/// `none`, a colour (#rgb, #rrggbb, rgb(), rgba(), a name of CSS), `currentColor`, `url(#id)`. A colour that
/// is more than half transparent is not painted.
/// @return empty for anything else.
std::optional<SvgPaint> parseSvgPaint(std::string_view text);

/// Metres of CSS's px: 1/96 inch.
constexpr double kSvgPixel_m = 0.0254 / 96.0;

struct SvgLength {
  double value = 0.0;
  std::string unit;  ///< as written: "", px, mm, cm, in, pt, pc, Q, %
  bool isPhysical() const { return !unit.empty() && unit != "px" && unit != "%"; }
  /// In user units (px).
  /// @param hundred_percent in user units.
  double units(double hundred_percent) const;
};
/// @return empty for anything else than a finite number (up to 1e9) with one of those units.
std::optional<SvgLength> parseSvgLength(std::string_view text);

/// Names and values; names in lower case.
using SvgDeclarations = std::map<std::string, std::string>;
/// Parses `fill: red; stroke-width: 2mm`. Parts without a colon are left out.
SvgDeclarations parseSvgDeclarations(std::string_view text);

/// The rules of `<style>` elements: selectors by element, .class and #id, together too (`rect.wall`), in
/// lists.
class SvgStyleSheet {
 public:
  /// @return the unsupported selectors (descendants, states), whose rules are left out.
  std::vector<std::string> add(std::string_view css);
  /// The declarations that apply to an element.
  /// @param classes its `class`.
  SvgDeclarations match(std::string_view element, std::string_view id, std::string_view classes) const;

 private:
  struct Rule {
    std::string element, id;
    std::vector<std::string> classes;
    SvgDeclarations declarations;
    int specificity() const;
  };
  std::vector<Rule> rules_;  // in their order
};

std::string trimmedSvg(std::string_view text);

}  // namespace vismem
