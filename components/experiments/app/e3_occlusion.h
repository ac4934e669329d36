/// @file E3: a second robot covers the view; the memory bridges it, and follows what really changes (figures
/// 16 to 18). SPEC E3, M10.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// In `room`: `stand` and `drive` (another robot close in front for 10 s), `remove` (a marking is taken away
/// in full view), `unseen` (how long what is out of view lives). Writes figure16_18_stand.png and
/// figure16_18_drive.png.
nlohmann::json occlusion(const ExperimentOptions& options);

}  // namespace vismem
