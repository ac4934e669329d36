/// @file E9: segments of Canny+Hough, the published Solis and ours in the same images (figure 3), and
/// labelled segments before and after merging (figure 10). Implements E9. See V2, V4.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/app/experiments.h"

namespace vismem {

/// Images: simulated (room, corridor, a textured floor), real where the data are at hand (a photograph of
/// york_urban_half, a frame of nao_field_2009). Writes figure3.png, figure10.png, one figure3_IMAGE.png for
/// each image, counts.csv and segments.csv. The JSON names missing images with the
/// reason.
nlohmann::json compareDetectors(const ExperimentOptions& options);

}  // namespace vismem
