/// @file E5: a humanoid travels a corridor; error over time (figure 20). Implements E5.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json travel(const ExperimentOptions& options);

}  // namespace vismem
