#include "experiments/app/health_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "evaluation/figures/canvas.h"

namespace vismem {
namespace {

constexpr double kMostLogRange = 40.0;  // of the logarithmic scale [nats]

/// From white over orange to a dark red, so that a small peak is seen.
Rgb heat(double health) {
  const double h = std::clamp(health, 0.0, 1.0);
  const auto between = [](double from, double to, double f) {
    return static_cast<int>(std::lround(from + (to - from) * f));
  };
  if (h < 0.5) return {255, between(255, 170, 2.0 * h), between(255, 60, 2.0 * h)};
  const double f = 2.0 * h - 1.0;
  return {between(255, 110, f), between(170, 0, f), between(60, 30, f)};
}

std::size_t bestOf(const HealthMap& map) {
  return static_cast<std::size_t>(std::max_element(map.health.begin(), map.health.end()) -
                                  map.health.begin());
}

Eigen::Vector2d placeOf(const HealthMap& map, std::size_t index) {
  const auto columns = static_cast<std::size_t>(map.columns);
  return map.place(static_cast<int>(index % columns), static_cast<int>(index / columns));
}

}  // namespace

cv::Mat drawHealthMap(const HealthMap& map, const SegmentMap& map_edges, const Pose2& truth, int width_px,
                      HealthScale scale) {
  const int cell = std::max(1, width_px / map.columns);
  const int width = cell * map.columns;
  const int height = cell * map.rows;
  const double least = *std::min_element(map.health.begin(), map.health.end());
  const double log_range = std::clamp(-std::log(least), 1.0, kMostLogRange);
  cv::Mat heats(height, width, CV_8UC3);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const double health = map.health[map.index(u / cell, map.rows - 1 - v / cell)];
      const Rgb color = heat(scale == HealthScale::kLinear ? health : 1.0 + std::log(health) / log_range);
      heats.at<cv::Vec3b>(v, u) =
          cv::Vec3b(static_cast<uchar>(color.r), static_cast<uchar>(color.g), static_cast<uchar>(color.b));
    }
  }
  Canvas canvas(width, height);
  canvas.picture(heats, {0.0, 0.0});
  const double px_per_m = cell / map.cell_m;
  // A place is the middle of its square.
  const auto at = [&](const Eigen::Vector2d& world) {
    const Eigen::Vector2d off = (world - map.low) * px_per_m;
    return Eigen::Vector2d(off.x() + 0.5 * cell, height - off.y() - 0.5 * cell);
  };
  for (const MapSegment& edge : map_edges.segments) {
    const Segment2 plan = edge.world.floor();
    canvas.line(at(plan.a), at(plan.b), colors::kFaintInk, 1.0);
  }
  constexpr double kArrow_m = 0.5;
  const Pose2 tip = truth * Pose2{kArrow_m, 0.0, 0.0};
  canvas.line(at(truth.position()), at(tip.position()), colors::kTruth, 2.5);
  canvas.disc(at(truth.position()), 4.5, colors::kTruth);
  canvas.circle(at(placeOf(map, bestOf(map))), 8.0, colors::kEstimate, 2.5);
  return canvas.finish();
}

HealthMapReading readHealthMap(const HealthMap& map, const Pose2& truth) {
  HealthMapReading reading;
  const std::size_t best = bestOf(map);
  reading.best = map.health[best];
  reading.off_m = (placeOf(map, best) - truth.position()).norm();
  for (std::size_t i = 0; i < map.health.size(); ++i) {
    const Eigen::Vector2d off = placeOf(map, i) - truth.position();
    if (off.cwiseAbs().maxCoeff() > map.cell_m) continue;
    reading.at_truth = std::max(reading.at_truth, static_cast<double>(map.health[i]));
  }
  const auto rivals = std::count_if(map.health.begin(), map.health.end(),
                                    [&](float health) { return health >= reading.at_truth; });
  reading.rivals = static_cast<double>(rivals) / static_cast<double>(map.health.size());
  return reading;
}

}  // namespace vismem
