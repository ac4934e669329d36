/// @file Programs that calibrate, run to their end.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/process/child_process.h"
#include "support/build_paths.h"

namespace vismem {

struct ToolRun {
  int code = -1;
  std::string out;
  std::string error;

  /// The last line.
  nlohmann::json summary() const {
    const auto end = out.find_last_not_of('\n');
    const auto begin = out.rfind('\n', end);
    return nlohmann::json::parse(out.substr(begin == std::string::npos ? 0 : begin + 1));
  }
};

inline ToolRun runTool(const std::string& program, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), std::string(VISMEM_BIN_DIR) + "/" + program);
  ChildProcess child(arguments);
  EXPECT_TRUE(child.waitForExit(std::chrono::seconds(110)));
  return {child.exitCode().value_or(-1), child.out(), child.error()};
}

inline ToolRun runCalibrate(std::vector<std::string> arguments) {
  return runTool("calibrate", std::move(arguments));
}

}  // namespace vismem
