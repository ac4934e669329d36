/// @file E9: what Canny+Hough, the published Solis and ours find in the same images (the chapter's figure 3),
/// and what merging does with the labelled segments (figure 10). SPEC E9, V2, V4.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// Images: simulated (room, corridor, a textured floor), real where the data are at hand (a photograph of
/// york_urban_half, a frame of nao_field_2009). Writes figure3.png, figure10.png, one figure3_IMAGE.png for
/// each image, counts.csv and segments.csv. Images that could not be had are named in the JSON with the
/// reason.
nlohmann::json compareDetectors(const ExperimentOptions& options);

}  // namespace vismem
