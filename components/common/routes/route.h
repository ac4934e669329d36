/// @file A route through a world: way-points, their file format, and the random start of a run. Pure except
/// for reading a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/pose.h"

namespace vismem {

/// Way-points joined by straight lines. Invariant: at least two, neighbours apart from each other.
struct Route {
  std::vector<Eigen::Vector2d> points;  ///< in world [m]
  bool closed = false;  ///< a loop from the last point to the first; otherwise driven back and forth

  double length() const;  ///< [m], including the closing line
  int lineCount() const { return static_cast<int>(points.size()) - (closed ? 0 : 1); }
  const Eigen::Vector2d& begin(int line) const { return points[line]; }
  const Eigen::Vector2d& end(int line) const { return points[(line + 1) % points.size()]; }
};

/// A place on a route: metres from its first point along it.
struct RoutePlace {
  double along_m = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  ///< of the line, towards the next way-point
};

/// @param along_m is wrapped into a closed route and clamped to an open one.
RoutePlace placeAlong(const Route& route, double along_m);
/// The nearest place of the route; the first one in a tie.
RoutePlace nearestPlace(const Route& route, const Eigen::Vector2d& position);

/// Reads a route: the line `closed` or `open`, the header `x_m,y_m`, then a way-point a line; `#` begins a
/// comment.
/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
Route parseRoute(std::string_view text, const std::string& file_name);
/// The same from a file. @throws ConfigError also when it cannot be read.
Route loadRoute(const std::filesystem::path& file);

/// Start of a run: a place of the route and one of its two directions, both drawn from the seed, with small
/// random offsets of lateral position and heading. The same seed gives the same start on every machine.
struct RouteStart {
  Pose2 T_world_robot;
  bool backwards = false;  ///< the route is to be driven from its last point to its first
};
RouteStart startOnRoute(const Route& route, std::uint64_t seed);

/// The same route in the other direction.
Route reversed(const Route& route);

}  // namespace vismem
