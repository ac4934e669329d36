/// @file CSV files of the experiments.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/tool/replace_file.h"

namespace vismem {

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
