/// @file Runs the trials of E5 and E6 at workers, with what is on disk from a run before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "experiments/app/trial_work.h"
#include "experiments/ice/worker_pool.h"

namespace vismem {

/// A TrialSource. Each finished method of a trial is on disk before it counts, so that the same command
/// continues after this process died. *Single-threaded*.
class TrialFarm {
 public:
  /// @param folder of the outcomes. @param commit of this program.
  /// @throws std::runtime_error naming a malformed proxy.
  TrialFarm(const std::filesystem::path& folder, std::string commit, std::vector<std::string> workers,
            std::string locator);

  /// The whole outcome of a trial. The first call for a series gives out all of its trials.
  /// @throws std::runtime_error when a worker fails, or when none answers.
  TrialOutcome operator()(const TrialSeries& series, std::uint64_t seed);

 private:
  void giveOut(const TrialSeries& series);
  std::string nameOf(const TrialSeries& series, std::uint64_t seed) const;

  const TrialFolder folder_;
  const std::string commit_;
  std::set<std::pair<std::string, std::uint64_t>> given_out_;  ///< names and seeds of series
  std::map<std::string, std::string> results_;  ///< whole outcomes by name; guarded by the pool's lock
  WorkerPool pool_;                             ///< last: its threads use the others
};

}  // namespace vismem
