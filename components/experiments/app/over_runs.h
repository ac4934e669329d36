/// @file The numbers of several runs of one experiment, summed up.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace vismem {

/// The structure of a run's JSON with, in place of each number that the runs have, its mean, least and most
/// and in how many runs it was (`mean`, `min`, `max`, `runs`); truth values count as 0 and 1. Texts, lists
/// and the run's own seed are left out.
nlohmann::json overRuns(const std::vector<nlohmann::json>& runs);

}  // namespace vismem
