/// @file Outlines of SVG: path data, ellipses, transforms, curves as straight pieces, strokes. Pure.
#pragma once

#include <Eigen/Geometry>
#include <string_view>
#include <vector>

namespace vismem {

/// A piece of an outline from the end of the previous one: a cubic Bezier curve or a straight line.
struct SvgCurve {
  Eigen::Vector2d control1 = Eigen::Vector2d::Zero();
  Eigen::Vector2d control2 = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  bool straight = false;
};

/// In the coordinates of its element (user units, y down).
struct SvgSubpath {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::vector<SvgCurve> curves;
  bool closed = false;
};
using SvgPath = std::vector<SvgSubpath>;

/// Corners of a polygon or of an open line.
using SvgPoints = std::vector<Eigen::Vector2d>;

/// The `d` of a path: all commands, absolute and relative, repeated, with numbers run together. Quadratic
/// curves and arcs become cubic ones (arcs to 5e-6 of their radius).
/// @throws std::invalid_argument with the problem and its character (from 1).
SvgPath parseSvgPath(std::string_view d);
/// A list of transforms: matrix, translate, scale, rotate, skewX, skewY.
/// @throws std::invalid_argument.
Eigen::Affine2d parseSvgTransform(std::string_view text);
/// Numbers between blanks and commas.
/// @throws std::invalid_argument.
std::vector<double> parseSvgNumbers(std::string_view text);

SvgPath svgPolyline(const SvgPoints& points, bool closed);
SvgPath svgEllipse(const Eigen::Vector2d& center, const Eigen::Vector2d& radii);
/// @param radii of the corners; either 0: none.
SvgPath svgRectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                     const Eigen::Vector2d& radii);

/// A subpath as straight pieces, at most `flatness` from the curve after the transform `T`.
/// @return its points in its own coordinates without repetitions; a closed one does not repeat the first
/// point.
SvgPoints flattenSvg(const SvgSubpath& subpath, const Eigen::Affine2d& T, double flatness);

struct SvgStroke {
  double width = 1.0;
  double miter_limit = 4.0;
};
/// The band of a stroke along a line, as overlapping convex polygons of one sense of rotation: mitred
/// corners up to the limit, cut off beyond it; ends without caps.
std::vector<SvgPoints> strokeSvg(const SvgPoints& line, bool closed, const SvgStroke& stroke);

}  // namespace vismem
