/// @file Command lines of tools, with the exit codes of components.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace vismem {

/// Exit code for a wrong command line or configuration, as of components, and for an input named there that
/// is missing or has mistakes (ConfigError); CLI11's own codes begin at 100. A recording, image or device
/// that turns out to be damaged, and an output that cannot be written, are failures: 1.
inline constexpr int kExitUsage = 2;

/// Parses the command line; prints help or the problem.
/// @return the exit code if the tool has to end: 0 after --help or --version, kExitUsage for a wrong command
/// line.
inline std::optional<int> parseTool(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
}

}  // namespace vismem
