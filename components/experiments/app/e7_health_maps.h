/// @file E7, E8: the health of every place, from images (figures 22 to 26) and from the memory (figure 27).
/// Implements E7. Implements E8.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json healthFromImages(const ExperimentOptions& options);
nlohmann::json healthFromMemory(const ExperimentOptions& options);

}  // namespace vismem
