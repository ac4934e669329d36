/// @file E4: the memory of a humanoid that walks and turns its neck, simulated and recorded (figure 19).
/// Implements E4. See G1.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// `corridor` and `field_6x4`: E1's way and figures with the setup `humanoid`, from a place on the world's
/// route. `nao`: the recording nao_field_2009 of options.data, images up to the loss of its camera pose.
/// Writes figure19_VARIANT.png, elements.csv, edges.csv. A recording that is not there is named in `absent`.
nlohmann::json humanoid(const ExperimentOptions& options);

}  // namespace vismem
