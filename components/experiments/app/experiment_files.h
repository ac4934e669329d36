/// @file Lines of text and CSV files of the experiments.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace vismem {

/// As printf, at most 400 characters.
std::string text(const char* pattern, auto... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, pattern, values...);
  return buffer;
}

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

class CsvFile {
 public:
  CsvFile(const std::filesystem::path& file, const char* head) : file_(file), out_(file) {
    out_ << head << '\n';
  }
  void row(const std::string& line) { out_ << line << '\n'; }
  /// @throws std::runtime_error naming the file when it could not be written.
  void close() {
    out_.close();
    if (!out_) throw std::runtime_error(file_.string() + ": cannot be written");
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace vismem
