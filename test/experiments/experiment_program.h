/// @file The program `experiment` in a temporary folder: runs, files and JSON.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>

#include "support/build_paths.h"

namespace vismem {

using testing::HasSubstr;
namespace fs = std::filesystem;

class ExperimentProgram : public testing::Test {
 protected:
  ExperimentProgram()
      : folder_(fs::temp_directory_path() / ("vismem_experiment_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ExperimentProgram() override { fs::remove_all(folder_); }

  int run(const std::string& arguments) {
    const std::string line = std::string(VISMEM_BIN_DIR) + "/experiment " + arguments + " > " +
                             (folder_ / "stdout").string() + " 2> " + (folder_ / "stderr").string();
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string content(const fs::path& name) const {
    std::ifstream in(folder_ / name);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  nlohmann::json lastLine() const {
    std::istringstream out(content("stdout"));
    std::string last;
    for (std::string line; std::getline(out, line);) last = line;
    return nlohmann::json::parse(last);
  }

  fs::path folder_;
};

}  // namespace vismem
