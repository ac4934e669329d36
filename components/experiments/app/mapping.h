/// @file The experiment "map": a map from one drive against the true edges. See B6.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// Variants: worlds and robots. Writes a plan of each map over the truth.
nlohmann::json mapping(const ExperimentOptions& options);

}  // namespace vismem
