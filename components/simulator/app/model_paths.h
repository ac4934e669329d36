/// @file The search path of models, with Gazebo's environment variables.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vismem {

/// The folders given first, then those of the variables GAZEBO_MODEL_PATH and GZ_SIM_RESOURCE_PATH.
std::vector<std::filesystem::path> modelPaths(const std::vector<std::string>& given);

}  // namespace vismem
