/// @file Files that are there as a whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace vismem {

/// Replaces a file as a whole: a program that is stopped meanwhile leaves the old file or the new one.
/// @throws std::runtime_error naming the file when it could not be written.
inline void replaceFile(const std::filesystem::path& file, const std::string& content) {
  std::filesystem::path unfinished = file;
  unfinished += ".unfinished";
  std::ofstream out(unfinished, std::ios::binary);
  out << content;
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(unfinished, file, failed);
  if (!out || failed) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace vismem
