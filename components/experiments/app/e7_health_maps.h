/// @file E7, E8: how well every place fits, from images (the chapter's figures 22 to 26) and from the memory
/// (figure 27).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

nlohmann::json healthFromImages(const ExperimentOptions& options);
nlohmann::json healthFromMemory(const ExperimentOptions& options);

}  // namespace vismem
