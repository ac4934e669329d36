/// @file E6 by who decides where the camera looks: salience alone, or localization too. SPEC B4.
#pragma once

#include "experiments/app/experiments.h"

namespace vismem {

/// @param options its gaze is not empty. @throws std::invalid_argument for a variant that it does not have.
nlohmann::json compareGaze(const ExperimentOptions& options);

}  // namespace vismem
