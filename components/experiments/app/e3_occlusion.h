/// @file E3: a second robot occludes the view; the memory bridges the occlusion and forgets removed objects
/// (figures 16 to 18). Implements E3. See M10.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// In `room`: `stand` and `drive` (another robot close in front for 10 s), `remove` (a marking is taken away
/// in full view), `unseen` (how long elements out of view live). Writes figure16_18_stand.png and
/// figure16_18_drive.png.
nlohmann::json occlusion(const ExperimentOptions& options);

}  // namespace vismem
