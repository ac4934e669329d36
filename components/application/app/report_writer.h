/// @file The files of a run, and its line of JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "application/app/options.h"
#include "application/app/run_inputs.h"
#include "application/core/run_record.h"

namespace vismem {

/// The result for scripts; unknown values are null. Keys carry their units.
nlohmann::json resultJson(const RunOptions& options, const RunSummary& summary);

/// Writes trajectory.tum, odometry.tum, truth.tum (simulation), memory.csv, races.csv, the figures
/// (top_view.png, error.png in a simulation, last_image.png) and result.json into options.out.
/// @throws std::runtime_error naming the file that cannot be written.
void writeReport(const RunOptions& options, const RunRecord& record, const RunSummary& summary,
                 const RunMap& map);

}  // namespace vismem
