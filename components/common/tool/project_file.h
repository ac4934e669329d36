/// @file Files of the project from any working directory.
#pragma once

#include <filesystem>

namespace vismem {

/// Finds a file named from the project's root: below the working directory, else below a folder above this
/// program.
/// @return `relative` itself if it is in neither, so that the error of opening it names it.
std::filesystem::path projectFile(const std::filesystem::path& relative);

}  // namespace vismem
