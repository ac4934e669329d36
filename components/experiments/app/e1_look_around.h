/// @file E1: the robot turns in the middle of a room; one image against the memory (figure 13).
/// Implements E1.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// `room`, `room` with more camera noise, with half a degree of tilt error, and `texture`. In each the robot
/// turns once on itself, then drives one metre and turns again; the memory is scored after both. Writes
/// figure13.png, elements.csv (every element with its verdict) and, per variant, plan_VARIANT.png.
nlohmann::json lookAround(const ExperimentOptions& options);

}  // namespace vismem
