#include "common/process/command_line.h"

#include <algorithm>

namespace vismem {

CommandLine parseCommandLine(const std::vector<std::string>& arguments,
                             const std::string& environment_config) {
  static const std::string kConfigOption = "--Ice.Config=";
  CommandLine result;
  std::vector<std::string> files;
  std::vector<std::string> settings;
  for (const auto& argument : arguments) {
    if (argument == "--help" || argument == "-h") {
      result.action = CommandLine::Action::kHelp;
      continue;
    }
    if (argument == "--list-keys") {
      result.action = CommandLine::Action::kListKeys;
      continue;
    }
    if (argument == "--version") {
      result.action = CommandLine::Action::kVersion;
      return result;
    }
    if (argument.starts_with(kConfigOption)) {
      files.push_back(argument.substr(kConfigOption.size()));
    } else if (argument.starts_with("-")) {
      settings.push_back(argument);
    } else {
      files.push_back(argument);
    }
  }
  const bool is_run = result.action == CommandLine::Action::kRun;
  if (is_run && files.empty() && !environment_config.empty()) files.push_back(environment_config);
  if (!files.empty()) result.properties = Properties::load(files.front());
  if (files.size() > 1) {
    result.properties.addProblem(
        {{"command line", 0},
         "two configuration files, " + files[0] + " and " + files[1] + " (must be one)"});
  }
  for (const auto& setting : settings) result.properties.addArgument(setting);
  return result;
}

}  // namespace vismem
