/// @file The shapes in memory: found among the markings of a room, and completed where an object occludes a
/// corner (figure 7). See M8, M9.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// E1's way in `room`. `open`: all shapes of cfg/maps/room.primitives.csv. `corner`: a box stands on one
/// corner of one of the two painted parallelograms. Writes shapes.csv, shapes_VARIANT.png and figure7.png (of
/// `corner`).
nlohmann::json primitives(const ExperimentOptions& options);

}  // namespace vismem
