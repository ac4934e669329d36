/// @file The one error of bad configuration, maps, palettes and calibrations. Pure.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace vismem {

/// Holds every problem found, one line each: "FILE:LINE: KEY = VALUE (RULE)", escaped for terminals
/// (text_file.h). what() joins the first kShownProblems and gives the number of the others.
class ConfigError : public std::runtime_error {
 public:
  static constexpr std::size_t kShownProblems = 20;

  explicit ConfigError(std::vector<std::string> problems);

  const std::vector<std::string>& problems() const { return problems_; }

 private:
  struct Shown {
    std::vector<std::string> lines;
  };
  explicit ConfigError(Shown problems);

  std::vector<std::string> problems_;
};

}  // namespace vismem
