/// @file E6 with different gaze policies: salience alone, or requests of localization too. See B4.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "experiments/app/trial_variants.h"

namespace vismem {

/// Begins the keys and the shipped file of its variants.
inline constexpr const char* kGazeExperiment = "E6_gaze";

/// The chosen variants: each policy is a method with records of its own.
/// @param options its gaze is not empty.
/// @throws ConfigError for an unknown variant.
std::vector<TrialVariant> gazeVariants(const ExperimentOptions& options);

/// Runs them.
nlohmann::json compareGaze(const ExperimentOptions& options);

}  // namespace vismem
