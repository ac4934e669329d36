/// @file Files of the project: configurations, worlds, maps.
#pragma once

#include <filesystem>

namespace vismem {

/// Finds a file named from the project's root, such as cfg/maps/corridor.palette: below the working
/// directory, else below a folder above this program, else below share/vismem of a folder above it
/// (installed).
/// @return `relative` itself if it is in neither, so that the error of opening it names it.
std::filesystem::path projectFile(const std::filesystem::path& relative);

/// The nearest place of a relative path in a folder or one above it.
/// @return empty without one.
std::filesystem::path findUpwards(std::filesystem::path folder, const std::filesystem::path& relative);

}  // namespace vismem
