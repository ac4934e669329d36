/// @file E4: the memory of a humanoid that sways while it walks and turns its neck, simulated and recorded
/// (figure 19). SPEC E4, G1.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// `corridor` and `field_6x4`: E1's way and figures with the setup `humanoid`, from a place on the world's
/// route. `nao`: the recording nao_field_2009 of options.data, images before its camera pose is no longer
/// known. Writes figure19_VARIANT.png, elements.csv, edges.csv. A recording that is not there is named in
/// `absent`.
nlohmann::json humanoid(const ExperimentOptions& options);

}  // namespace vismem
