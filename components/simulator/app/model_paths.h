/// @file The search path of models, with Gazebo's environment variables.
#pragma once

#include <filesystem>
#include <vector>

namespace vismem {

/// These folders first, then those of the variables GAZEBO_MODEL_PATH and GZ_SIM_RESOURCE_PATH.
std::vector<std::filesystem::path> modelPaths(std::vector<std::filesystem::path> paths);

}  // namespace vismem
