/// @file A calibrated body as keys of active_visual_memory.cfg. Pure.
#pragma once

#include <vector>

#include "calibration/core/body/body_estimator.h"
#include "calibration/core/body/setup_edit.h"

namespace vismem {

/// Keys of what is observable; what is not keeps its old value and is not listed.
/// @param described the mounting that the configuration has now.
/// @param reported_base_m with which the wheels were fitted.
std::vector<KeyValue> bodyKeys(const BodyEstimate& estimate, const CameraMount& described,
                               double reported_base_m);

}  // namespace vismem
