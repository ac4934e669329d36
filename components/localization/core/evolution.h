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

/// Rates every individual, orders them best first, and sets the race's pose to the mean of its elite
/// (headings on the circle) and its health to the elite's mean health.
void rateRace(Race& race, const EvolutionParams& params,
              const std::function<double(const Pose2&)>& health_of);

/// The next generation from a rated race: the elite unchanged, means of random pairs, disturbed copies of
/// random individuals. The new ones have no health until the race is rated again.
void evolveRace(Race& race, const EvolutionParams& params, RandomEngine& engine);

}  // namespace vismem
