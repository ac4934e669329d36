#include "localization/core/hypotheses/explorers.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {

Pose2 uniformExplorer(const MapIndex& map, double margin_m, RandomEngine& engine) {
  const double x = uniform(engine, map.low().x() - margin_m, map.high().x() + margin_m);
  const double y = uniform(engine, map.low().y() - margin_m, map.high().y() + margin_m);
  return {x, y, wrapAngle(uniform(engine, -std::numbers::pi, std::numbers::pi))};
}

double uniformShare(const MapIndex& map, double margin_m, double area_m2) {
  const Eigen::Vector2d extent = (map.high() - map.low()).array() + 2.0 * margin_m;
  const double map_m2 = extent.x() * extent.y();
  return area_m2 > 0.0 && map_m2 > area_m2 ? area_m2 / map_m2 : 1.0;
}

ConstructedExplorers::ConstructedExplorers(const MapIndex& map) {
  for (int label = 0; label < map.labelCount(); ++label) {
    std::vector<Line>& lines = by_label_.emplace_back();
    double sum = 0.0;
    for (const Segment2& segment : map.floor(label)) lines.push_back({sum += segment.length(), segment});
  }
}

std::optional<Pose2> ConstructedExplorers::propose(const FloorObservation& observation,
                                                   RandomEngine& engine) const {
  if (observation.segments.empty() || !(observation.segment_weight > 0.0)) return std::nullopt;
  double left = uniform(engine, 0.0, observation.segment_weight);
  std::size_t chosen = 0;
  while (chosen + 1 < observation.segments.size() && left > observation.segments[chosen].weight) {
    left -= observation.segments[chosen++].weight;
  }
  const ObservedSegment& seen = observation.segments[chosen];
  const std::vector<Line>& lines = by_label_[static_cast<std::size_t>(seen.label)];
  if (lines.empty() || !(lines.back().sum > 0.0)) return std::nullopt;
  const auto drawn =
      std::upper_bound(lines.begin(), std::prev(lines.end()), uniform(engine, 0.0, lines.back().sum),
                       [](double sum, const Line& one) { return sum < one.sum; });
  Segment2 line = drawn->plan;
  const bool turned = uniform(engine, 0.0, 1.0) < 0.5;
  const bool by_end = uniform(engine, 0.0, 1.0) < 0.5;
  if (turned) std::swap(line.a, line.b);
  const double heading = wrapAngle(line.direction() - seen.robot.direction());
  // Fractions of the observed and the map segment that coincide.
  double fraction_seen = uniform(engine, 0.0, 1.0);
  double fraction_map = uniform(engine, 0.0, 1.0);
  if (by_end) fraction_seen = fraction_map = fraction_map < 0.5 ? 0.0 : 1.0;
  const Eigen::Vector2d p_robot = seen.robot.a + fraction_seen * (seen.robot.b - seen.robot.a);
  const Eigen::Vector2d p_world = line.a + fraction_map * (line.b - line.a);
  const Eigen::Vector2d arm = transform(Pose2{0.0, 0.0, heading}, p_robot);
  return Pose2{p_world.x() - arm.x(), p_world.y() - arm.y(), heading};
}

int explorerCount(const ExplorerParams& params, double reliability, bool is_idle, std::uint64_t iteration) {
  const bool is_reliable = reliability >= params.reliable_above;
  const bool pauses = iteration % static_cast<std::uint64_t>(params.period_reliable) != 0;
  if (pauses && (is_reliable || is_idle)) return 0;
  return is_reliable ? params.count_reliable : params.count_lost;
}

void keepBestPlaces(std::vector<Individual>& explorers, int count, double list_health,
                    const RaceParams& races) {
  std::erase_if(explorers, [&](const Individual& one) { return one.health < list_health; });
  // Sorting by insertion is stable and takes no memory; few explorers are left.
  for (auto one = explorers.begin(); one != explorers.end(); ++one) {
    const auto place =
        std::upper_bound(explorers.begin(), one, *one,
                         [](const Individual& a, const Individual& b) { return a.health > b.health; });
    std::rotate(place, one, std::next(one));
  }
  auto end = explorers.begin();
  for (const Individual& explorer : explorers) {
    if (end - explorers.begin() >= count) break;
    const bool is_known = std::any_of(explorers.begin(), end, [&](const Individual& other) {
      return samePlace(explorer.T_world_robot, other.T_world_robot, races);
    });
    if (!is_known) *end++ = explorer;
  }
  explorers.erase(end, explorers.end());
}

}  // namespace vismem
