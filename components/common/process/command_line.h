/// @file The command line of every component. Pure, except reading the configuration file that it names.
#pragma once

#include <string>
#include <vector>

#include "common/config/properties.h"

namespace vismem {

struct CommandLine {
  enum class Action { kRun, kHelp, kListKeys, kVersion };

  Action action = Action::kRun;
  /// The keys of the file, overridden by those of the command line, and all problems of both.
  Properties properties;
};

/// [FILE | --Ice.Config=FILE] [--Key=Value ...] [--help] | --list-keys | --version. Help and list read the
/// named keys, because some of them bring others: a driver's name its driver's.
/// @param arguments           without the program's name.
/// @param environment_config  value of ICE_CONFIG: the file if the arguments name none; may be empty.
CommandLine parseCommandLine(const std::vector<std::string>& arguments,
                             const std::string& environment_config);

}  // namespace vismem
