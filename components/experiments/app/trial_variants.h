/// @file E5, a humanoid that travels a corridor (figure 20), and E6, symmetries and kidnappings (figure 21):
/// their variants, read from files. Implements E5, E6.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/config/properties.h"
#include "experiments/app/experiments.h"
#include "experiments/app/trial_series.h"

namespace vismem {

struct TrialVariant {
  std::string name;
  TrialSeries series;  ///< without seed; its name is the variant's
};

/// The variants NAME of the keys EXPERIMENT.Variant.NAME.KEY, in the order of their names. The experiments'
/// README lists the keys.
/// @throws ConfigError with all problems.
std::vector<TrialVariant> readTrialVariants(const Properties& properties, const std::string& experiment);

/// The variants that the options select, of their file or of cfg/experiments/EXPERIMENT.variants, with the
/// options' seed, methods and number of trials.
/// @throws ConfigError, for an unknown variant naming those that there are.
std::vector<TrialVariant> chosenTrialVariants(const std::string& experiment,
                                              const ExperimentOptions& options);

/// The series of a variant as its `origin` describes it, for one trial: without seed and number of trials.
/// @throws ConfigError, std::invalid_argument, nlohmann::json::exception for another text.
TrialSeries seriesFrom(const std::string& origin);

/// Runs them, each with every method on the same trials.
/// @param files begins the names of their files.
nlohmann::json runTrialVariants(const std::string& experiment, const std::string& files,
                                const ExperimentOptions& options);

}  // namespace vismem
