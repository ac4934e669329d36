/// @file The command line of run_application (DESIGN 11).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace vismem {

enum class Setup { kSimulation, kReplay };

struct RunOptions {
  Setup setup = Setup::kSimulation;
  std::string folder = "sim";     ///< under cfg/: "sim", "humanoid", "replay"
  std::optional<double> seconds;  ///< of the robot's time; empty: until Ctrl-C or the recording's end
  std::uint64_t seed = 1;
  int port_offset = 0;
  std::filesystem::path root;   ///< of the project: holds cfg/
  std::filesystem::path bin;    ///< holds the components' programs
  std::filesystem::path world;  ///< simulation only
  std::filesystem::path route;  ///< simulation only: beside the world
  std::filesystem::path scenario;  ///< simulation only; empty: none
  std::filesystem::path bag;    ///< replay only
  std::filesystem::path map;
  std::filesystem::path palette;  ///< beside the map; empty: there is none, the configuration's holds
  std::filesystem::path out;
};

/// The command line makes no sense. what() is one message for people.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the command line and looks every named file up, so that nothing is started that cannot go on.
/// @return empty after --help, which is printed.
/// @throws UsageError.
std::optional<RunOptions> parseOptions(int argc, char** argv);

}  // namespace vismem
