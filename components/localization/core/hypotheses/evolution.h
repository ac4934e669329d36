/// @file The genetic search inside a race. Pure. Implements L9.
#pragma once

#include <functional>

#include "common/geometry/angles.h"
#include "localization/core/hypotheses/race.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// Chapter mode.
struct EvolutionParams {
  int individuals = 30;
  double elitism = 0.2;
  double crossover = 0.2;  ///< the rest is mutation
  /// Thermal noise, uniform within +-: at birth it covers the distance to the nearest explorer; mutation
  /// searches finely, because each image moves a race by about this much where it fits as well elsewhere.
  double birth_noise_m = 0.10;
  double birth_noise_rad = degToRad(15.0);
  double noise_m = 0.03;
  double noise_rad = degToRad(3.0);
};

/// Number of individuals that pass unchanged, at least one.
int eliteCount(const EvolutionParams& params);

/// A pose moved by thermal noise: uniform within +- in x, y and heading.
Pose2 withThermalNoise(const Pose2& pose, double noise_m, double noise_rad, RandomEngine& engine);

/// Mean position, and mean heading on the circle.
Pose2 meanPose(const Pose2& a, const Pose2& b);

/// A race around an explorer: the explorer itself and thermally disturbed copies of it. Unrated.
Race createRace(const Individual& explorer, const EvolutionParams& params, RandomEngine& engine);

/// Health of a pose.
using HealthOf = std::function<double(const Pose2&)>;

/// Rates the unrated individuals and sorts the elite to the front, best first. The race gets the elite's mean
/// pose (headings averaged on the circle) and mean health. The others keep their order without a health.
void rateRace(Race& race, const EvolutionParams& params, const HealthOf& health_of);

/// The next generation from a rated race: the elite unchanged, means of random pairs, and disturbed copies of
/// random individuals. New individuals are unrated.
void evolveRace(Race& race, const EvolutionParams& params, RandomEngine& engine);

}  // namespace vismem
