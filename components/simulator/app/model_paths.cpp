#include "simulator/app/model_paths.h"

#include <cstdlib>
#include <sstream>
#include <string>

namespace vismem {

std::vector<std::filesystem::path> modelPaths(std::vector<std::filesystem::path> paths) {
  for (const char* variable : {"GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH"}) {
    const char* value = std::getenv(variable);
    std::istringstream folders(value == nullptr ? "" : value);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (!folder.empty()) paths.emplace_back(folder);
    }
  }
  return paths;
}

}  // namespace vismem
