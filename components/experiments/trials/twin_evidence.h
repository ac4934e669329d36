/// @file Time at which images have shown evidence for the true one of two aliased places. Pure. See E6.
#pragma once

#include <optional>

#include "experiments/trials/trial.h"
#include "localization/core/map/map_index.h"

namespace vismem {

struct TwinEvidenceParams {
  double on_map_m = 0.15;   ///< largest distance of a point from the map's lines at the true place
  double off_map_m = 0.30;  ///< least distance of a point of evidence from all lines at the twin place
  double enough_m = 0.5;    ///< sufficient length of floor lines with evidence, summed over images
  /// An image adds at most this much, so that one line in many images is not sufficient.
  double most_per_image_m = 0.25;
};

/// Seconds from an event until the images had shown sufficient lines that fit the true place and not its
/// twin.
/// @param T_world_twin maps the world onto its twin: a half turn about the middle of `corridor`.
/// @param map with brute force or fields, with a direction gate.
/// @return empty: never.
std::optional<double> evidenceAfter(const Trial& trial, std::size_t event, const Pose2& T_world_twin,
                                    const MapIndex& map, const TwinEvidenceParams& params = {});

}  // namespace vismem
