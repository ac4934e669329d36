/// @file The genetic search inside a race. Pure. SPEC L9.
#pragma once

#include <functional>

#include "localization/core/params.h"
#include "localization/core/race.h"
#include "localization/core/random_engine.h"

namespace vismem {

/// Number of individuals that pass unchanged, at least one.
int eliteCount(const EvolutionParams& params);

/// A pose moved by thermal noise: uniform in x, y and heading.
Pose2 withThermalNoise(const Pose2& pose, const EvolutionParams& params, RandomEngine& engine);

/// Mean position, and mean heading on the circle.
Pose2 meanPose(const Pose2& a, const Pose2& b);

/// A race around an explorer: the explorer itself and thermally disturbed copies of it. Not yet rated.
Race foundRace(const Individual& explorer, const EvolutionParams& params, RandomEngine& engine);

/// Tells the health of a place. @param least what is certainly under it may be told as 0.
using HealthOf = std::function<double(const Pose2&, double least)>;

/// Rates the individuals that are not, finds the race's elite, puts it first, the best before the others, and
/// sets the race's pose to its mean (headings on the circle) and the race's health to its mean health. The
/// rest keep their order and no health: nothing asks who of them is better.
void rateRace(Race& race, const EvolutionParams& params, const HealthOf& health_of);

/// The next generation from a rated race: the elite unchanged, means of random pairs, disturbed copies of
/// random individuals. The new ones have no health until the race is rated again.
void evolveRace(Race& race, const EvolutionParams& params, RandomEngine& engine);

}  // namespace vismem
