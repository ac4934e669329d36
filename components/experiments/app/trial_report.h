/// @file Runs methods on the same recorded trials, compares them and writes the results. See E5, E6.
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

  /// @param known_start names of the methods that get the true pose at the beginning.
  void add(const Trial& trial, const SegmentMap& map_edges, const std::vector<std::string>& known_start = {});
  /// Gives the trial to the method of this name alone, for trials in its own closed loop.
  /// @throws std::invalid_argument for a name that no method has.
  void addTo(const std::string& method, const Trial& trial, const SegmentMap& map_edges);
  /// For aliased places: stores when each event of the last added trial had shown evidence against the twin
  /// place, for the methods that got this trial.
  void noteEvidence(const std::vector<std::optional<double>>& evidence_after_s);

  const std::vector<MethodRecord>& records() const { return records_; }
  /// Error of a method over time in the last added trial, as in the chapter's figures 20 and 21.
  void drawLast(const std::string& method, const std::filesystem::path& file) const;

  /// Writes all events so far into NAME_events.csv and the figures into NAME.json. Each file is replaced as a
  /// whole, so that a run that is stopped keeps its results.
  /// @return the figures. @throws std::runtime_error naming a file that cannot be written.
  nlohmann::json write(const std::filesystem::path& out, const SummaryParams& params = {}) const;
  /// The same, with a table for people and NAME.png (shares recovered over time).
  nlohmann::json report(const std::filesystem::path& out, const SummaryParams& params = {}) const;

 private:
  void run(std::size_t method, const Trial& trial, const SegmentMap& map_edges, bool is_start_known);

  std::string name_;
  std::string title_;
  std::vector<MethodMaker> methods_;
  std::vector<MethodRecord> records_;
  struct Last {                   ///< last trial of a method
    bool is_newest = false;       ///< it is the trial added last
    std::size_t first_event = 0;  ///< of it, among the record's events
    Trial trial;                  ///< without its updates
    std::vector<PublishedPose> poses;
  };
  std::vector<Last> last_;  ///< of each method
};

nlohmann::json toJson(const TrialSummary& summary);

}  // namespace vismem
