/// @file Trials as tasks for other processes. See E5, E6.
#pragma once

#include <cstdint>
#include <string>

#include "experiments/app/trial_series.h"

namespace vismem {

/// A trial of a series as a task (JSON).
/// @param commit of the sources; only a program of the same commit runs the task.
std::string trialTask(const TrialSeries& series, std::uint64_t seed, const std::string& commit);

/// Whether this program can run a task. @return the problem; empty: it can.
std::string problemOfTrialTask(const std::string& task, const std::string& commit);

/// Runs a task.
/// @param parts outcome so far (JSON); empty: none.
/// @param part gets the outcome so far (JSON) after each method.
/// @return the whole outcome (JSON).
std::string runTrialTask(const std::string& task, const std::string& parts, const std::function<void()>& look,
                         const std::function<void(const std::string&)>& part);

/// Outcomes on disk, one file a trial: what a stopped run has done already.
class TrialFolder {
 public:
  /// Makes the folder. @throws std::filesystem::filesystem_error.
  explicit TrialFolder(std::filesystem::path folder);
  /// The stored outcome of exactly this task, whole or in parts; empty (no text) without one.
  std::string load(const std::string& name, const std::string& task) const;
  /// Replaces the file in one step. @throws std::runtime_error naming it.
  void save(const std::string& name, const std::string& task, const std::string& outcome) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace vismem
