/// @file Style of SVG elements: colours, lengths, inherited presentation attributes. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "simulator/core/svg_path.h"
#include "simulator/core/svg_report.h"

namespace vismem {

using SvgColor = std::array<std::uint8_t, 3>;  ///< R G B

struct SvgPaint {
  std::optional<SvgColor> color;  ///< empty: not painted
};
/// `none`, `transparent`, #rgb, #rrggbb, rgb(), one of the 17 colour names of CSS 2.1.
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

/// Inherited and own style of an element.
struct SvgLook {
  SvgPaint fill{SvgColor{0, 0, 0}};
  SvgPaint stroke;
  SvgStroke pen;
  std::string join = "miter";
  std::string cap = "butt";
  bool even_odd = false;
  bool visible = true;
  double fill_opacity = 1.0;
  double stroke_opacity = 1.0;
  double opacity = 1.0;      ///< of all around it, multiplied
  bool fixed_width = false;  ///< its stroke has no width in the world
  std::string label;
};
/// Attributes and the `style` attribute, which wins.
/// @param around inherited style.
/// @param report gets wrong values, and effects that are left out.
SvgLook svgLookOf(const tinyxml2::XMLElement& e, const SvgLook& around, SvgReport& report);

}  // namespace vismem
