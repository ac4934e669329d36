/// @file E2: before and in a curve of a corridor (figures 14, 15). SPEC E2; DESIGN 11.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// Variants: the same follower of the walls' feet knows the memory (`memory`) or the current image only, with
/// the same attending gaze (`image`) or with a camera that stays looking ahead (`image_ahead`).
nlohmann::json followCurve(const ExperimentOptions& options);

}  // namespace vismem
