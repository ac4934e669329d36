/// @file The subcommands of `calibrate`. Each is one file calibrate_NAME.cpp; calibrate.cpp lists them.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace vismem {

struct CalibrateCommand {
  CLI::App* options = nullptr;  ///< of the subcommand
  /// Runs after parsing. @return the exit code. @throw ConfigError for a wrong file or value (exit code 2),
  /// another std::exception for a failure (exit code 1).
  std::function<int()> run;
};

CalibrateCommand addTargetCommand(CLI::App& calibrate);
CalibrateCommand addLensCommand(CLI::App& calibrate);
CalibrateCommand addBodyCommand(CLI::App& calibrate);
CalibrateCommand addCheckCommand(CLI::App& calibrate);

}  // namespace vismem
