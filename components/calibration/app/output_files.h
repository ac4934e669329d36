/// @file Files that `calibrate` writes.
#pragma once

#include <filesystem>
#include <string>

namespace vismem {

/// Writes a whole file and creates its folder; what stood there stays until the new one is complete.
/// @throw std::runtime_error naming the file.
void writeWholeFile(const std::filesystem::path& file, const std::string& bytes);

}  // namespace vismem
