#include "localization/core/hypotheses/evolution.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Sets pose and health to the elite's mean. All individuals of a race are near one place.
void setToElite(Race& race, const EvolutionParams& params) {
  const int elite = std::min(eliteCount(params), static_cast<int>(race.individuals.size()));
  if (elite == 0) return;
  double x = 0.0;
  double y = 0.0;
  double health = 0.0;
  std::vector<double> headings;
  for (int i = 0; i < elite; ++i) {
    const Individual& one = race.individuals[static_cast<std::size_t>(i)];
    x += one.T_world_robot.x;
    y += one.T_world_robot.y;
    health += one.health;
    headings.push_back(one.T_world_robot.theta);
  }
  race.T_world_robot = {x / elite, y / elite, circularMean(headings)};
  race.health = health / elite;
}

}  // namespace

int eliteCount(const EvolutionParams& params) {
  return std::max(1, static_cast<int>(std::lround(params.elitism * params.individuals)));
}

Pose2 withThermalNoise(const Pose2& pose, double noise_m, double noise_rad, RandomEngine& engine) {
  // Three statements: the order of evaluation of arguments is not defined, and runs must repeat.
  const double dx = uniform(engine, -noise_m, noise_m);
  const double dy = uniform(engine, -noise_m, noise_m);
  const double turn = uniform(engine, -noise_rad, noise_rad);
  return {pose.x + dx, pose.y + dy, wrapAngle(pose.theta + turn)};
}

Pose2 meanPose(const Pose2& a, const Pose2& b) {
  const double headings[] = {a.theta, b.theta};
  return {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), circularMean(headings)};
}

Race createRace(const Individual& explorer, const EvolutionParams& params, RandomEngine& engine) {
  Race race;
  race.T_world_robot = explorer.T_world_robot;
  race.health = explorer.health;
  race.individuals.push_back(explorer);
  while (static_cast<int>(race.individuals.size()) < params.individuals) {
    race.individuals.push_back(
        {withThermalNoise(explorer.T_world_robot, params.birth_noise_m, params.birth_noise_rad, engine)});
  }
  return race;
}

void rateRace(Race& race, const EvolutionParams& params, const HealthOf& health_of) {
  const auto most = static_cast<std::size_t>(eliteCount(params));
  std::vector<Individual>& all = race.individuals;
  std::vector<std::size_t> elite;  // indices, best first
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].is_rated) all[i].health = health_of(all[i].T_world_robot);
    all[i].is_rated = true;
    const double health = all[i].health;
    // Behind individuals of equal health: a stable order makes runs repeatable.
    elite.insert(std::upper_bound(elite.begin(), elite.end(), health,
                                  [&](double mine, std::size_t other) { return mine > all[other].health; }),
                 i);
    if (elite.size() > most) elite.pop_back();
  }
  std::vector<Individual> ordered;
  ordered.reserve(all.size());
  for (const std::size_t i : elite) ordered.push_back(all[i]);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::find(elite.begin(), elite.end(), i) == elite.end()) ordered.push_back({all[i].T_world_robot});
  }
  all = std::move(ordered);
  setToElite(race, params);
}

void evolveRace(Race& race, const EvolutionParams& params, RandomEngine& engine) {
  const std::vector<Individual>& parents = race.individuals;
  if (parents.empty()) return;
  const auto elite = static_cast<std::size_t>(eliteCount(params));
  const auto crossed = static_cast<std::size_t>(std::lround(params.crossover * params.individuals));
  std::vector<Individual> next(
      parents.begin(), parents.begin() + static_cast<std::ptrdiff_t>(std::min(elite, parents.size())));
  for (std::size_t i = 0; i < crossed; ++i) {
    const Pose2& first = parents[pick(engine, parents.size())].T_world_robot;
    const Pose2& second = parents[pick(engine, parents.size())].T_world_robot;
    next.push_back({meanPose(first, second)});
  }
  while (static_cast<int>(next.size()) < params.individuals) {
    const Pose2& parent = parents[pick(engine, parents.size())].T_world_robot;
    next.push_back({withThermalNoise(parent, params.noise_m, params.noise_rad, engine)});
  }
  race.individuals = std::move(next);
}

}  // namespace vismem
