/// @file A memory's score as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluation/core/memory_score.h"

namespace vismem {

nlohmann::json toJson(const MemoryScore& score);

}  // namespace vismem
