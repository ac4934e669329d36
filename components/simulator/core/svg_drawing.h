/// @file The painted shapes and lines of an SVG drawing, in metres on the floor. Pure.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "simulator/core/svg_style.h"

namespace vismem {

/// Strokes narrower than this are lines without width; wider ones are painted bands with two edges [m].
constexpr double kWidestPen_m = 0.03;

struct SvgOptions {
  /// Metres per user unit of the outermost element. Empty: from its physical width and height and `scale`.
  std::optional<double> metres_per_unit;
  double scale = 1.0;  ///< of a drawing on paper: 50 for one of 1:50
  /// The world's (0, 0), in user units of the file (y down). Empty: the attribute `data-origin="X Y"` of the
  /// outermost element, else the drawing's lower left corner.
  std::optional<Eigen::Vector2d> origin;
  double flatness_m = 0.002;  ///< maximum distance of straight pieces from a curve
  /// Maximum number of corners of all outlines, which bounds time and memory.
  std::size_t max_points = 50'000;
};

using DrawnRing = std::vector<Eigen::Vector2d>;  ///< closed, without its first point again, in the world [m]

/// The inside of an outline, or the band of a stroke. Later shapes lie above earlier ones.
struct DrawnShape {
  std::vector<DrawnRing> rings;
  bool even_odd = false;  ///< else: nonzero winding rule
  SvgColor color{};
};

/// The middle line of a stroke.
struct DrawnLine {
  std::vector<Eigen::Vector2d> points;  ///< in the world [m]
  bool closed = false;
  SvgColor color{};
  double width_m = 0.0;   ///< 0: of no width (non-scaling-stroke, or only labelled)
  std::string label;      ///< label in the file (data-label); may be empty
  std::string where;      ///< "FILE:LINE: <path id="x">", for messages
  std::size_t above = 0;  ///< shapes painted before it
};

struct SvgDrawing {
  std::vector<DrawnShape> shapes;   ///< in the order of painting
  std::vector<DrawnLine> pens;      ///< strokes narrower than kWidestPen_m
  std::vector<DrawnLine> labelled;  ///< outlines and lines of elements with data-label, of any colour
  std::vector<std::string> warnings;
};

/// Reads a drawing: rect, circle, ellipse, line, polyline, polygon, path, in groups; transforms, viewBox,
/// units; presentation attributes and style attributes. The world's y is up. Style sheets, copies (`use`) and
/// drawings within drawings are refused; other drawn elements and effects are left out with a warning.
/// @param file for messages only.
/// @throws ConfigError with every problem: FILE:LINE: <element id>: attribute = value (what it must be); also
/// without a size in the file and in the options.
SvgDrawing parseSvgDrawing(const std::string& bytes, const std::string& file, const SvgOptions& options);

}  // namespace vismem
