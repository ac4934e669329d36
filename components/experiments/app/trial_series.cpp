#include "experiments/app/trial_series.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/config/config_error.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "experiments/trials/twin_evidence.h"
#include "localization/core/likelihood/robust_likelihood.h"

namespace vismem {
namespace {

std::vector<std::optional<double>> evidenceOf(const Trial& trial, const SegmentMap& map_edges,
                                              const LocalizerParams& ours) {
  const MapIndex map(map_edges, robustIndex(ours.robust.likelihood, ours.map));
  const Pose2 half_turn{0.0, 0.0, std::numbers::pi};
  std::vector<std::optional<double>> all;
  for (std::size_t event = 0; event < trial.events_us.size(); ++event) {
    all.push_back(evidenceAfter(trial, event, half_turn, map));
  }
  return all;
}

/// Adds the chapter's figures, and to each method whether all of its own are better.
void addPublished(const PublishedResult& published, const Comparison& comparison, const SummaryParams& params,
                  nlohmann::json& json) {
  for (const MethodRecord& record : comparison.records()) {
    json[record.name]["better_than_published"] = isBetterThan(published, summarize(record.events, params));
  }
  json["published"] = {{"position_error_m", published.position_error_m},
                       {"heading_error_deg", radToDeg(published.heading_error_rad)}};
  if (published.recovery_s) json["published"]["median_s"] = *published.recovery_s;
}

std::vector<MethodMaker> chosen(std::vector<MethodMaker> methods, const std::vector<std::string>& only) {
  if (only.empty()) return methods;
  std::vector<MethodMaker> kept;
  for (const std::string& name : only) {
    const auto found = std::find_if(methods.begin(), methods.end(),
                                    [&](const MethodMaker& method) { return method.name == name; });
    if (found == methods.end()) {
      throw ConfigError(
          {"no method \"" + name + "\" here (there are " + joined(methods, ", ", &MethodMaker::name) + ")"});
    }
    kept.push_back(*found);
  }
  return kept;
}

/// What is missing of a record: makers of methods without an outcome.
std::vector<MethodMaker> missingOf(const std::vector<MethodMaker>& all, const TrialRecording& recording,
                                   const RecordOutcome& record) {
  std::vector<MethodMaker> missing;
  for (const MethodMaker& maker : all) {
    if (!recording.method.empty() && recording.method != maker.name) continue;
    const bool is_done = std::any_of(record.methods.begin(), record.methods.end(),
                                     [&](const MethodOutcome& done) { return done.method == maker.name; });
    if (!is_done) missing.push_back(maker);
  }
  return missing;
}

/// Makes one record and gives it to the methods that lack an outcome.
void fillRecord(const TrialSeries& series, const TrialRecording& recording, std::size_t index,
                TrialOutcome& outcome, const TrialWatch& watch) {
  const auto look = [&watch] {
    if (watch.look) watch.look();
  };
  TrialOptions options = series.trial;
  options.seed = outcome.seed;
  if (recording.change) recording.change(options);
  TrialRun run(options);
  const auto makers = chosen(series.methods(run.params().localizer), series.only);
  if (index == outcome.records.size()) outcome.records.emplace_back();
  RecordOutcome& record = outcome.records[index];
  const auto missing = missingOf(makers, recording, record);
  if (missing.empty()) return;
  const Trial trial = run.record([&look](const TrialRun::Step&, GazeClient&) { look(); });
  record.gaze_plan_ms = trial.gaze_plan_ms;
  record.gaze_requests = trial.gaze_requests;
  record.truth = trial.truth;
  record.events_us = trial.events_us;
  const auto evidence = series.twins ? evidenceOf(trial, run.params().map_edges, run.params().localizer)
                                     : std::vector<std::optional<double>>();
  for (const MethodMaker& maker : missing) {
    const bool is_start_known = recording.method.empty() &&
                                std::find(series.known_start.begin(), series.known_start.end(), maker.name) !=
                                    series.known_start.end();
    record.methods.push_back(runMethod(maker, trial, run.params().map_edges, is_start_known, look));
    noteEvidence(evidence, record.methods.back());
    if (watch.part) watch.part(outcome);
  }
}

/// Names of the methods in an outcome, in their order.
std::vector<std::string> methodsIn(const TrialOutcome& outcome) {
  std::vector<std::string> names;
  for (const RecordOutcome& record : outcome.records) {
    for (const MethodOutcome& method : record.methods) names.push_back(method.method);
  }
  return names;
}

}  // namespace

TrialOutcome runTrial(const TrialSeries& series, std::uint64_t seed, TrialOutcome so_far,
                      const TrialWatch& watch) {
  so_far.seed = seed;
  for (std::size_t i = 0; i < series.recordings.size() && !so_far.is_whole; ++i) {
    fillRecord(series, series.recordings[i], i, so_far, watch);
  }
  so_far.is_whole = true;
  return so_far;
}

std::vector<std::uint64_t> seedsOf(const TrialSeries& series) {
  std::vector<std::uint64_t> seeds;
  for (int i = 1; i <= series.trials; ++i) seeds.push_back(kSeedsApart * series.seed + i);
  return seeds;
}

nlohmann::json runSeries(const TrialSeries& series, const std::filesystem::path& out,
                         const TrialSource& source,
                         const std::function<void(const Comparison&, nlohmann::json&)>& add_figures) {
  const auto began = std::chrono::steady_clock::now();
  const auto spent_s = [&began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  const std::vector<std::uint64_t> seeds = seedsOf(series);
  const std::string range = std::to_string(seeds.front()) + ".." + std::to_string(seeds.back());
  std::optional<Comparison> comparison;
  std::vector<double> plan_ms;
  int gaze_requests = 0;
  for (const std::uint64_t seed : seeds) {
    const TrialOutcome trial = source ? source(series, seed) : runTrial(series, seed);
    if (!comparison) {
      comparison.emplace(series.name, series.title + "; seeds " + range, methodsIn(trial));
      for (const std::string& method : series.drawn) {
        drawErrorsOf(trial, method, out / (series.name + "_" + method + ".png"));
      }
    }
    for (const RecordOutcome& record : trial.records) {
      plan_ms.insert(plan_ms.end(), record.gaze_plan_ms.begin(), record.gaze_plan_ms.end());
      gaze_requests += record.gaze_requests;
      for (const MethodOutcome& method : record.methods) comparison->add(method);
    }
    comparison->write(out, series.summary);
    std::cerr << formatted("  %s: seed %llu of %s, %.0f s so far\n", series.name.c_str(),
                           static_cast<unsigned long long>(seed), range.c_str(), spent_s());
  }
  nlohmann::json json = comparison->report(out, series.summary);
  if (series.published) addPublished(*series.published, *comparison, series.summary, json);
  if (!plan_ms.empty()) {
    json["gaze_plan_ms_mean"] = mean(plan_ms).value_or(0.0);
    json["gaze_plan_ms_p99"] = quantile(plan_ms, 0.99).value_or(0.0);
    json["gaze_requests"] = gaze_requests;
  }
  if (add_figures) add_figures(*comparison, json);
  json["seeds"] = {seeds.front(), seeds.back()};
  json["took_s"] = spent_s();
  std::cerr << formatted("  took %.0f s\n", spent_s());
  return json;
}

}  // namespace vismem
