/// @file Statistics over several runs of one experiment.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace vismem {

/// The structure of a run's JSON with the statistics of each number in its place: `mean`, `min`, `max`, and
/// `runs`, the number of runs that have it. Truth values count as 0 and 1. Texts, lists and the seed are left
/// out.
nlohmann::json overRuns(const std::vector<nlohmann::json>& runs);

}  // namespace vismem
