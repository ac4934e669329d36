/// @file E2: a robot before and in a curve of a corridor (figures 14, 15). Implements E2.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// Variants: a corridor follower with the walls of the memory (`memory`), of the current image with the same
/// attending gaze (`image`), or of the current image with the camera fixed ahead (`image_ahead`).
nlohmann::json followCurve(const ExperimentOptions& options);

}  // namespace vismem
