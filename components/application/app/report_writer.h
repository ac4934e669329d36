/// @file The files of a run, and its line of JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "application/app/options.h"
#include "evaluation/report/run_files.h"
#include "evaluation/report/run_pictures.h"
#include "evaluation/report/run_record.h"

namespace vismem {

/// The result for scripts; unknown values are null. Keys carry their units.
nlohmann::json resultJson(const RunOptions& options, const RunSummary& summary);

/// Ends the files of the run, and writes the figures and result.json.
/// @return one line for each file that cannot be written; the others are.
std::vector<std::string> writeReport(const RunOptions& options, RunFiles& files, const RunRecord& record,
                                     const RunSummary& summary, const RunMap& map);

}  // namespace vismem
