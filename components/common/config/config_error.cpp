#include "common/config/config_error.h"

#include <algorithm>
#include <utility>

#include "common/config/text_file.h"

namespace vismem {
namespace {

std::vector<std::string> fitToBeShown(std::vector<std::string> lines) {
  for (auto& line : lines) line = shown(line);
  return lines;
}

std::string joinLines(const std::vector<std::string>& lines) {
  std::string text;
  const std::size_t count = std::min(lines.size(), ConfigError::kShownProblems);
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : "\n") + lines[i];
  if (lines.size() > count) text += "\nand " + std::to_string(lines.size() - count) + " more problems";
  return text;
}

}  // namespace

ConfigError::ConfigError(std::vector<std::string> problems)
    : ConfigError(Shown{fitToBeShown(std::move(problems))}) {}

ConfigError::ConfigError(Shown problems)
    : std::runtime_error(joinLines(problems.lines)), problems_(std::move(problems.lines)) {}

}  // namespace vismem
