/// @file The folder of recordings and annotated images outside the project.
#pragma once

#include <cstdlib>
#include <filesystem>

#include "support/build_paths.h"

namespace vismem {

/// AVM_DATA, else ../shared/data seen from the project's root. May be absent: tests are skipped then.
inline std::filesystem::path dataFolder() {
  const char* data = std::getenv("AVM_DATA");
  return data != nullptr ? std::filesystem::path(data)
                         : std::filesystem::path(VISMEM_SOURCE_DIR) / "../shared/data";
}

}  // namespace vismem
