/// @file What of the memory and its gaze may change while the component runs.
#pragma once

#include <atomic>

#include "active_visual_memory/app/config.h"
#include "active_visual_memory/app/perception_loop.h"
#include "common/process/parameter_table.h"

namespace vismem {

/// Lists the parameters; the loop's owner thread takes a new value before the next image.
/// @param overlay_rate_hz read by whoever draws the overlay. It and the loop outlive the table's use.
void listMemoryParameters(ParameterTable& table, const ActiveVisualMemoryConfig& config, PerceptionLoop& loop,
                          std::atomic<double>& overlay_rate_hz);

}  // namespace vismem
