/// @file E6: symmetries and kidnappings (the chapter's figure 21), and what else spoils localization.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json kidnapping(const ExperimentOptions& options);

}  // namespace vismem
