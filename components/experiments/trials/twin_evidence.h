/// @file When a robot between two places that look alike has seen what tells them apart. Pure. SPEC E6.
#pragma once

#include <optional>

#include "experiments/trials/trial.h"
#include "localization/core/map_index.h"

namespace vismem {

struct TwinEvidenceParams {
  double on_map_m = 0.15;   ///< a seen point is the map's line when it is this near at the true place ..
  double off_map_m = 0.30;  ///< .. and speaks against the twin when it is farther from all lines there
  double enough_m = 0.5;    ///< length of floor lines that speaks against the twin, summed over images;
  /// so that one line seen again and again does not make it up alone, an image adds at most this much.
  double most_per_image_m = 0.25;
};

/// Seconds after an event until the images had shown enough that fits the true place and not its twin.
/// @param T_world_twin maps the world onto its twin: a half turn about the middle of `corridor`.
/// @param map with brute force or fields, with a direction gate.
/// @return empty if never.
std::optional<double> evidenceAfter(const Trial& trial, std::size_t event, const Pose2& T_world_twin,
                                    const MapIndex& map, const TwinEvidenceParams& params = {});

}  // namespace vismem
