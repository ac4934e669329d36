/// @file E6: symmetries and kidnappings (figure 21), false segments, lost segments and blackouts.
/// Implements E6.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json kidnapping(const ExperimentOptions& options);

}  // namespace vismem
