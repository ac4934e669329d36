/// @file The chapter's experiments by name: SPEC E1-E9, DESIGN 11.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace vismem {

struct ExperimentOptions {
  std::string mode = "default";  ///< "default" or "chapter"
  std::uint64_t seed = 1;
  std::string variant;  ///< only the variant of this name; empty: all
  /// Of E6: "salience", "localization", "oracle", "both", "all"; empty: no question of gaze.
  std::string gaze;
  std::vector<std::string> methods;  ///< of E5 and E6: only these; empty: all
  int trials = 0;                    ///< of experiments over many runs: how many; 0: as many as it needs
  std::filesystem::path out;         ///< exists; everything is written there
  std::filesystem::path data;        ///< recordings and photographs; may be absent
};

struct Experiment {
  std::string name;   ///< "E9"
  std::string title;  ///< for people
  /// Writes figures and CSV files into options.out. @return what it found, for the last line and result.json.
  /// @throws std::exception with what is wrong with an input.
  std::function<nlohmann::json(const ExperimentOptions&)> run;
};

/// In the order of their names.
const std::vector<Experiment>& experiments();

}  // namespace vismem
