/// @file Angles in radians: wrapping, differences, circular means. Pure.
#pragma once

#include <numbers>
#include <span>

namespace vismem {

constexpr double degToRad(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }
constexpr double radToDeg(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

/// @return the same direction in (-pi, pi]. The input must be finite.
double wrapAngle(double angle_rad);

/// @return the signed turn from `from_rad` to `to_rad`, in (-pi, pi].
double angleDifference(double to_rad, double from_rad);

/// Angle between two undirected lines given by their directions.
/// @return in [0, pi/2].
double lineAngleDifference(double a_rad, double b_rad);

/// Mean direction: the angle of the sum of unit vectors (see L9: averages are taken on the circle).
/// @return in (-pi, pi]; 0 for an empty span or directions that cancel out.
double circularMean(std::span<const double> angles_rad);

}  // namespace vismem
