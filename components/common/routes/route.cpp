#include "common/routes/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "common/geometry/segment.h"

namespace vismem {
namespace {

/// Way-points nearer than this have no direction between them [m].
constexpr double kMinimumLine_m = 0.05;

/// Uniform in [0, 1): the standard's distributions differ between libraries, its engines do not.
double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1.0p-53;
}

RoutePlace placeOnLine(const Route& route, int line, double before_m, double fraction) {
  const Eigen::Vector2d d = route.end(line) - route.begin(line);
  return {before_m + fraction * d.norm(), route.begin(line) + fraction * d, std::atan2(d.y(), d.x())};
}

}  // namespace

double Route::length() const {
  double sum = 0.0;
  for (int i = 0; i < lineCount(); ++i) sum += (end(i) - begin(i)).norm();
  return sum;
}

RoutePlace placeAlong(const Route& route, double along_m) {
  const double length = route.length();
  if (route.closed) {
    along_m = std::fmod(along_m, length);
    if (along_m < 0.0) along_m += length;
  } else {
    along_m = std::clamp(along_m, 0.0, length);
  }
  double before = 0.0;
  for (int i = 0; i < route.lineCount(); ++i) {
    const double line = (route.end(i) - route.begin(i)).norm();
    if (along_m <= before + line || i + 1 == route.lineCount()) {
      return placeOnLine(route, i, before, std::min(1.0, (along_m - before) / line));
    }
    before += line;
  }
  return {};
}

RoutePlace nearestPlace(const Route& route, const Eigen::Vector2d& position) {
  RoutePlace best;
  double best_distance = std::numeric_limits<double>::infinity();
  double before = 0.0;
  for (int i = 0; i < route.lineCount(); ++i) {
    const Segment2 line{route.begin(i), route.end(i)};
    const double fraction = std::clamp(projectionFraction(position, line), 0.0, 1.0);
    const RoutePlace place = placeOnLine(route, i, before, fraction);
    const double distance = (place.position - position).norm();
    if (distance < best_distance) {
      best_distance = distance;
      best = place;
    }
    before += line.length();
  }
  return best;
}

Route parseRoute(std::string_view text, const std::string& file_name) {
  Route route;
  std::vector<std::string> problems;
  int line_number = 0;
  int content_lines = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = contentOf(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_number;
    if (line.empty()) continue;
    const std::string where = file_name + ":" + std::to_string(line_number) + ": ";
    const std::string found = "\"" + std::string(line) + "\"";
    ++content_lines;
    if (content_lines == 1) {
      if (line != "closed" && line != "open") problems.push_back(where + found + " (must be closed or open)");
      route.closed = line == "closed";
      continue;
    }
    if (content_lines == 2) {
      if (line != "x_m,y_m") problems.push_back(where + found + " (must be the header x_m,y_m)");
      continue;
    }
    const std::size_t comma = line.find(',');
    const auto x = finiteNumber(line.substr(0, comma));
    const auto y = comma == std::string_view::npos ? std::nullopt : finiteNumber(line.substr(comma + 1));
    if (!x || !y) {
      problems.push_back(where + found + " (must be two finite numbers: x_m,y_m)");
      continue;
    }
    if (std::abs(*x) > kFarthest_m || std::abs(*y) > kFarthest_m) {
      problems.push_back(where + found + " (must be within 100 km of the origin)");
      continue;
    }
    const Eigen::Vector2d point(*x, *y);
    if (!route.points.empty() && (point - route.points.back()).norm() < kMinimumLine_m) {
      problems.push_back(where + found + " (must be 0.05 m or more from the way-point before)");
    }
    route.points.push_back(point);
  }
  if (route.points.size() < 2 && problems.empty()) {
    problems.push_back(file_name + ": " + std::to_string(route.points.size()) +
                       " way-points (must be 2 or more)");
  }
  if (problems.empty() && route.closed &&
      (route.points.front() - route.points.back()).norm() < kMinimumLine_m) {
    problems.push_back(file_name +
                       ": the last way-point repeats the first (a closed route joins them by itself)");
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return route;
}

Route loadRoute(const std::filesystem::path& file) {
  return parseRoute(readTextFile(file, "the way-points of a route"), file.string());
}

RouteStart startOnRoute(const Route& route, std::uint64_t seed) {
  constexpr double kPlayBeside_m = 0.10;
  constexpr double kPlayHeading_rad = 0.26;  // 15 degrees
  // A seed sequence decorrelates the starts of neighbouring seeds.
  std::seed_seq spread{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), 0x726f7574u};
  std::mt19937_64 engine(spread);
  const RoutePlace place = placeAlong(route, uniform(engine) * route.length());
  RouteStart start;
  start.backwards = uniform(engine) < 0.5;
  const double beside = kPlayBeside_m * (2.0 * uniform(engine) - 1.0);
  const double turned = kPlayHeading_rad * (2.0 * uniform(engine) - 1.0);
  const double heading = place.heading_rad + (start.backwards ? std::numbers::pi : 0.0);
  start.T_world_robot = {place.position.x() - beside * std::sin(place.heading_rad),
                         place.position.y() + beside * std::cos(place.heading_rad),
                         wrapAngle(heading + turned)};
  return start;
}

Route reversed(const Route& route) {
  Route result = route;
  std::reverse(result.points.begin(), result.points.end());
  return result;
}

}  // namespace vismem
