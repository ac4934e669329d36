/// @file Methods on the same recorded trials: run, compared, and written down. SPEC E5, E6; PEERS.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiments/trials/trial_method.h"
#include "experiments/trials/trial_score.h"

namespace vismem {

/// A method over all trials of a comparison.
struct MethodRecord {
  std::string name;
  std::vector<EventScore> events;
  std::vector<double> cycle_ms;  ///< CPU time of the updates that made a cycle (a tick)
};

/// Gives every method the same trials, one after the other. *Single-threaded*.
class Comparison {
 public:
  /// @param title for people. @param name of files: "irregular".
  Comparison(std::string name, std::string title, std::vector<MethodMaker> methods);

  /// @param known_start the methods of these names are told the true pose at the beginning.
  void add(const Trial& trial, const SegmentMap& map_edges, const std::vector<std::string>& known_start = {});
  /// For the places that look alike: notes when each event of the last added trial showed what tells.
  void noteEvidence(const std::vector<std::optional<double>>& evidence_after_s);

  const std::vector<MethodRecord>& records() const { return records_; }
  /// Error of a method over time in the last added trial, as in the chapter's figures 20 and 21.
  void drawLast(const std::string& method, const std::filesystem::path& file) const;

  /// Writes NAME_events.csv and NAME.png (shares recovered over time) into the folder and prints the table.
  /// @return the figures. @throws std::runtime_error naming a file that cannot be written.
  nlohmann::json report(const std::filesystem::path& out, const SummaryParams& params = {}) const;

 private:
  std::string name_;
  std::string title_;
  std::vector<MethodMaker> methods_;
  std::vector<MethodRecord> records_;
  std::size_t last_added_ = 0;                          ///< index of the first event of the last trial
  Trial last_;                                          ///< without its updates
  std::vector<std::vector<PublishedPose>> last_poses_;  ///< of each method
};

nlohmann::json toJson(const TrialSummary& summary);

}  // namespace vismem
