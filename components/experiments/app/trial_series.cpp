#include "experiments/app/trial_series.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "common/geometry/angles.h"
#include "experiments/app/experiment_files.h"
#include "experiments/trials/twin_evidence.h"

namespace vismem {
namespace {

std::vector<std::optional<double>> evidenceOf(const Trial& trial, const SegmentMap& map_edges,
                                              const LocalizerParams& ours) {
  MapIndex::Params index;
  index.cell_m = ours.map.cell_m;
  index.direction_gate_rad = ours.robust.likelihood.direction_gate_rad;
  index.minimum_plan_length_m = 0.03;
  const MapIndex map(map_edges, index);
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
  std::string known;
  for (const MethodMaker& method : methods) known += (known.empty() ? "" : ", ") + method.name;
  std::vector<MethodMaker> kept;
  for (const std::string& name : only) {
    const auto found = std::find_if(methods.begin(), methods.end(),
                                    [&](const MethodMaker& method) { return method.name == name; });
    if (found == methods.end()) {
      throw std::invalid_argument("no method \"" + name + "\" here (there are " + known + ")");
    }
    kept.push_back(*found);
  }
  return kept;
}

}  // namespace

nlohmann::json runSeries(const TrialSeries& series, const std::filesystem::path& out,
                         const std::function<void(const Comparison&, nlohmann::json&)>& add_figures) {
  const auto began = std::chrono::steady_clock::now();
  const auto spent_s = [&began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  const std::uint64_t first = kSeedsApart * series.seed + 1;
  const std::uint64_t last = first + static_cast<std::uint64_t>(series.trials) - 1;
  std::optional<Comparison> comparison;
  std::vector<double> plan_ms;
  int gaze_requests = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    for (const TrialRecording& recording : series.recordings) {
      TrialOptions options = series.trial;
      options.seed = seed;
      if (recording.change) recording.change(options);
      TrialRun run(options);
      if (!comparison) {
        comparison.emplace(
            series.name,
            text("%s; seeds %llu..%llu", series.title.c_str(), static_cast<unsigned long long>(first),
                 static_cast<unsigned long long>(last)),
            chosen(series.methods(run.params().localizer), series.only));
      }
      const Trial trial = run.record();
      plan_ms.insert(plan_ms.end(), trial.gaze_plan_ms.begin(), trial.gaze_plan_ms.end());
      gaze_requests += trial.gaze_requests;
      if (recording.method.empty()) {
        comparison->add(trial, run.params().map_edges, series.known_start);
      } else {
        comparison->addTo(recording.method, trial, run.params().map_edges);
      }
      if (series.twins) {
        comparison->noteEvidence(evidenceOf(trial, run.params().map_edges, run.params().localizer));
      }
    }
    if (seed == first) {
      for (const std::string& method : series.drawn) {
        comparison->drawLast(method, out / (series.name + "_" + method + ".png"));
      }
    }
    comparison->write(out, series.summary);
    std::cerr << text("  %s: seed %llu of %llu..%llu, %.0f s so far\n", series.name.c_str(),
                      static_cast<unsigned long long>(seed), static_cast<unsigned long long>(first),
                      static_cast<unsigned long long>(last), spent_s());
  }
  nlohmann::json json = comparison->report(out, series.summary);
  if (series.published) addPublished(*series.published, *comparison, series.summary, json);
  if (!plan_ms.empty()) {
    json["gaze_plan_ms_mean"] = mean(plan_ms).value_or(0.0);
    json["gaze_plan_ms_p99"] = quantile(plan_ms, 0.99).value_or(0.0);
    json["gaze_requests"] = gaze_requests;
  }
  if (add_figures) add_figures(*comparison, json);
  json["seeds"] = {first, last};
  json["took_s"] = spent_s();
  std::cerr << text("  took %.0f s\n", spent_s());
  return json;
}

}  // namespace vismem
