/// @file The outcome of one trial: what each method made of its records, and its JSON. See E5, E6.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/core/metrics.h"
#include "experiments/trials/trial_method.h"
#include "experiments/trials/trial_score.h"

namespace vismem {

struct MethodOutcome {
  std::string method;
  std::vector<EventScore> events;
  std::vector<double> cycle_ms;  ///< CPU time of the updates that made a cycle (a tick)
  std::vector<PublishedPose> poses;
};

/// Of one record of the trial: a series has one for all methods, or one for each.
struct RecordOutcome {
  std::vector<MethodOutcome> methods;
  std::vector<double> gaze_plan_ms;
  int gaze_requests = 0;
  Trajectory truth;
  std::vector<StampUs> events_us;
};

struct TrialOutcome {
  std::uint64_t seed = 0;
  std::vector<RecordOutcome> records;  ///< in the order of the series; the last may lack methods
  bool is_whole = false;
};

/// Runs a method over a record.
/// @param is_start_known gives it the true pose at the first update.
/// @param look called before each update; what it throws ends the run.
MethodOutcome runMethod(const MethodMaker& maker, const Trial& trial, const SegmentMap& map_edges,
                        bool is_start_known, const std::function<void()>& look = {});

/// Stores when each event had shown evidence against the twin place.
void noteEvidence(const std::vector<std::optional<double>>& evidence_after_s, MethodOutcome& outcome);

/// Without loss: reading gives the same numbers.
/// @param with_path adds poses and truth, which pictures need.
nlohmann::json toJson(const TrialOutcome& outcome, bool with_path);
/// @throws nlohmann::json::exception for JSON of another form.
TrialOutcome trialOutcomeFrom(const nlohmann::json& json);

}  // namespace vismem
