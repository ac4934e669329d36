/// @file Expected messages for invalid configurations. To add a case, add an entry to one of the tables.
#pragma once

#include <string>
#include <vector>

namespace vismem::test {

/// One broken configuration: the component is started in an empty folder with a file `broken.cfg`, and must
/// end with exactly these messages.
struct BrokenConfig {
  struct File {
    std::string name;
    std::string content;
  };

  std::string name;  ///< letters and digits: the test's name
  std::string component;
  /// Lines of broken.cfg. The keys of the component's smallest valid configuration that they do not set
  /// follow below them, so line numbers count from these.
  std::vector<std::string> lines;
  /// Line by line; HERE stands for the folder and PORT for a port that is in use. A run-time failure (exit
  /// code 1) is a line of the log, without its stamp and name; other lines than errors are ignored.
  std::vector<std::string> expected;
  int exit_code = 2;
  std::vector<std::string> without = {};    ///< keys of the valid configuration that are left out
  std::vector<File> files = {};             ///< in the folder; map.csv, world.sdf and map.palette are there
  std::vector<std::string> arguments = {};  ///< instead of --Ice.Config=broken.cfg
  std::string whole = {};                   ///< if not empty: all of broken.cfg, byte for byte
};

std::vector<BrokenConfig> filesAndLines();
std::vector<BrokenConfig> valuesOfKeys();
std::vector<BrokenConfig> proxiesAndEndpoints();
std::vector<BrokenConfig> mapsAndPalettes();
std::vector<BrokenConfig> worlds();
std::vector<BrokenConfig> recordings();
std::vector<BrokenConfig> servers();

}  // namespace vismem::test
