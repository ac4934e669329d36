/// @file Compares methods over the outcomes of trials and writes the results. See E5, E6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiments/app/trial_outcome.h"
#include "experiments/trials/trial_score.h"

namespace vismem {

/// A method over all trials of a comparison.
struct MethodRecord {
  std::string name;
  std::vector<EventScore> events;
  std::vector<double> cycle_ms;  ///< of MethodOutcome
};

/// Compares methods over many trials. *Single-threaded*.
class Comparison {
 public:
  /// @param title for people. @param name of files: "irregular".
  Comparison(std::string name, std::string title, const std::vector<std::string>& methods);

  /// @throws std::invalid_argument for a method that is not compared.
  void add(const MethodOutcome& outcome);

  const std::vector<MethodRecord>& records() const { return records_; }

  /// Writes all events so far into NAME_events.csv and the figures into NAME.json. Each file is replaced as a
  /// whole, so that a run that is stopped keeps its results.
  /// @return the figures. @throws std::runtime_error naming a file that cannot be written.
  nlohmann::json write(const std::filesystem::path& out, const SummaryParams& params = {}) const;
  /// The same, with a table for people and NAME.png (shares recovered over time).
  nlohmann::json report(const std::filesystem::path& out, const SummaryParams& params = {}) const;

 private:
  std::string name_;
  std::string title_;
  std::vector<MethodRecord> records_;
};

/// Error of a method over time in a trial with its path, as in the chapter's figures 20 and 21.
void drawErrorsOf(const TrialOutcome& trial, const std::string& method, const std::filesystem::path& file);

nlohmann::json toJson(const TrialSummary& summary);

}  // namespace vismem
