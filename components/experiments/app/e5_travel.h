/// @file E5: a humanoid travels a corridor (the chapter's figure 20).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json travel(const ExperimentOptions& options);

}  // namespace vismem
