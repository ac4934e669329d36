/// @file E6 with different gaze policies: salience alone, or requests of localization too. See B4.
#pragma once

#include "experiments/app/experiments.h"

namespace vismem {

/// @param options its gaze is not empty.
/// @throws std::invalid_argument for an unknown variant.
nlohmann::json compareGaze(const ExperimentOptions& options);

}  // namespace vismem
