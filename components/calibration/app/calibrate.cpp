/// @file calibrate PART: lens, mounting and odometry of a robot by looking at a board. See its --help.
#include <iostream>
#include <vector>

#include "calibration/app/commands.h"
#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"

int main(int argc, char** argv) {
  CLI::App app(
      "Calibrates a robot. Parts in their order: target (print a board), lens, body; check "
      "daily.",
      "calibrate");
  app.require_subcommand(1);
  const std::vector<vismem::CalibrateCommand> commands{
      vismem::addTargetCommand(app), vismem::addLensCommand(app), vismem::addBodyCommand(app),
      vismem::addCheckCommand(app)};
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    for (const auto& command : commands) {
      if (command.options->parsed()) return command.run();
    }
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 1;
}
