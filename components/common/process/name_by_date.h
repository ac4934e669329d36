/// @file Names of folders that are made now.
#pragma once

#include <filesystem>
#include <string>

namespace vismem {

/// The local time: "20261123-140501".
std::string nameByDate();

/// @return prefix and local time, with "-2", "-3" .. when the folder has this name already.
std::string unusedNameByDate(const std::filesystem::path& folder, const std::string& prefix = "");

}  // namespace vismem
