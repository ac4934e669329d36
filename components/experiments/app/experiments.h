/// @file The chapter's experiments by name. See E1, E2, E3, E4, E5, E6, E7, E8, E9.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace vismem {

struct TrialOutcome;
struct TrialSeries;
/// Provides the whole outcome of a trial, for example from another process.
using TrialSource = std::function<TrialOutcome(const TrialSeries&, std::uint64_t seed)>;

struct ExperimentOptions {
  std::string mode = "default";  ///< "default" or "chapter"
  std::uint64_t seed = 1;
  std::string variant;             ///< only the variant of this name; empty: all
  std::filesystem::path variants;  ///< of E5 and E6: file of their variants; empty: the shipped one
  std::string variants_text;       ///< content of that file, where it lies on another machine; else empty
  /// Of E6: "salience", "localization", "oracle", "both", "all"; empty: no gaze comparison.
  std::string gaze;
  std::vector<std::string> methods;  ///< of E5 and E6: only these; empty: all
  int trials = 0;                    ///< of experiments over many runs: their number; 0: the default
  std::filesystem::path out;         ///< exists; all files are written there
  std::filesystem::path data;        ///< recordings and photographs; may be absent
  TrialSource source;                ///< of E5 and E6: who runs the trials; empty: this process

  bool wants(const std::string& name) const { return variant.empty() || variant == name; }
  /// For the title of a figure: "default mode, seed 1".
  std::string modeAndSeed() const { return mode + " mode, seed " + std::to_string(seed); }
};

struct Experiment {
  std::string name;   ///< "E9"
  std::string title;  ///< for people
  /// Writes figures and CSV files into options.out.
  /// @return the figures of merit, for the last line and result.json; empty when it has no such variant.
  /// @throws std::exception naming a wrong input.
  std::function<nlohmann::json(const ExperimentOptions&)> run;
};

/// In the order of their names.
const std::vector<Experiment>& experiments();

}  // namespace vismem
