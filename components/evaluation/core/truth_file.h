/// @file The true poses of a recording as a text file. Pure.
#pragma once

#include <string>
#include <string_view>

#include "evaluation/core/trajectory.h"

namespace vismem {

/// Reads rows of numbers with commas between: `t_s,x_m,y_m,theta_rad`, in the map's frame. With a header line
/// these four columns are found by name, in any order among others; without one they are the first four.
/// Columns beside them are not read. Empty lines and lines that begin with `#` are skipped.
/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
Trajectory parseTruth(std::string_view text, const std::string& file_name);

}  // namespace vismem
