/// @file The one error of bad configuration, maps, palettes and calibrations. Pure.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace vismem {

/// Carries every problem found, one line each: "FILE:LINE: KEY = VALUE (RULE)". what() joins them.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> problems);

  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

}  // namespace vismem
