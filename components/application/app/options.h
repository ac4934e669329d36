/// @file The command line of run_application.
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
  /// Starts the server of the page in the browser too, where the setup has one.
  bool gui = true;
  std::filesystem::path root;      ///< of the project: holds cfg/
  std::filesystem::path bin;       ///< holds the components' programs
  std::filesystem::path world;     ///< simulation only
  std::filesystem::path route;     ///< simulation only: beside the world
  std::filesystem::path scenario;  ///< simulation only; empty: none
  std::filesystem::path bag;       ///< replay only
  std::filesystem::path session;   ///< replay only: a recorded folder with its configurations; empty: none
  std::string topics;              ///< replay only: ROLE=/topic,...; empty: found by type
  bool record = false;             ///< with the recorder, into out/recording
  std::filesystem::path map;
  bool own_frame = false;         ///< simulation only: of the map, in which the world's truth has no meaning
  std::filesystem::path palette;  ///< named, or beside the map; empty: the configuration's
  std::filesystem::path out;      ///< OutFolder makes it
};

/// A wrong command line. what() is one message.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that a key of a component names in the setup. @return empty: the key is not set.
std::filesystem::path fileOfSetup(const RunOptions& options, const std::string& component,
                                  const std::string& key);

/// Reads the command line and checks that every named file exists, before anything is started.
/// @return empty after --help, which is printed.
/// @throws UsageError.
std::optional<RunOptions> parseOptions(int argc, char** argv);

}  // namespace vismem
