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
  /// Gives the trial to the method of this name alone: of trials that the method itself had a part in.
  /// @throws std::invalid_argument for a name that no method has.
  void addTo(const std::string& method, const Trial& trial, const SegmentMap& map_edges);
  /// For the places that look alike: notes when each event of the last added trial showed what tells, for the
  /// methods that were given it last.
  void noteEvidence(const std::vector<std::optional<double>>& evidence_after_s);

  const std::vector<MethodRecord>& records() const { return records_; }
  /// Error of a method over time in the last added trial, as in the chapter's figures 20 and 21.
  void drawLast(const std::string& method, const std::filesystem::path& file) const;

  /// Writes all events so far into NAME_events.csv and the figures into NAME.json: whole files in the place
  /// of the last ones, so that a run that is cut short leaves what it did.
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
  struct Last {                   ///< what a method did last
    bool is_newest = false;       ///< in the trial that was added last
    std::size_t first_event = 0;  ///< of it, among the record's events
    Trial trial;                  ///< without its updates
    std::vector<PublishedPose> poses;
  };
  std::vector<Last> last_;  ///< of each method
};

nlohmann::json toJson(const TrialSummary& summary);

}  // namespace vismem
