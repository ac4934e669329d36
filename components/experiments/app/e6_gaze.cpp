#include "experiments/app/e6_gaze.h"

#include <array>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/config/text_format.h"
#include "experiments/app/trial_variants.h"

namespace vismem {
namespace {

struct Policy {
  const char* name;
  TrialGaze gaze;
  bool in_both;  ///< of `--gaze both`
};
constexpr std::array<Policy, 3> kPolicies{{{"salience", TrialGaze::kSalience, true},
                                           {"localization", TrialGaze::kLocalization, true},
                                           {"oracle", TrialGaze::kOracle, false}}};

/// Recovery times of a policy over those of the first.
nlohmann::json ratios(const Comparison& comparison, std::size_t policy, const SummaryParams& params) {
  const auto& records = comparison.records();
  nlohmann::json json;
  for (const double q : {0.5, 0.9}) {
    const auto ratio = ratioOfQuantiles(records[policy].events, records[0].events, q, params);
    const char* name = q == 0.5 ? "median_ratio" : "p90_ratio";
    if (!ratio) {
      json[name] = nullptr;
      continue;
    }
    json[name] = {{"value", ratio->value}, {"low", ratio->interval.low}, {"high", ratio->interval.high}};
    std::cerr << formatted("  %s of recovery, %s against %s: %.2f (%.2f..%.2f)\n",
                           q == 0.5 ? "median" : "p90", records[policy].name.c_str(), records[0].name.c_str(),
                           ratio->value, ratio->interval.low, ratio->interval.high);
  }
  return json;
}

}  // namespace

std::vector<TrialVariant> gazeVariants(const ExperimentOptions& options) {
  if (!options.methods.empty()) throw ConfigError({"E6 --gaze compares gaze: it has no --methods"});
  auto variants = chosenTrialVariants(kGazeExperiment, options);
  for (TrialVariant& variant : variants) {
    TrialSeries& series = variant.series;
    series.name = "gaze_" + variant.name;
    // Each gaze policy is a method: the same localization on the record of its own closed loop.
    std::vector<std::string> names;
    series.recordings.clear();
    for (const Policy& policy : kPolicies) {
      const bool is_wanted =
          options.gaze == "all" || options.gaze == policy.name || (options.gaze == "both" && policy.in_both);
      if (!is_wanted) continue;
      names.emplace_back(policy.name);
      series.recordings.push_back(
          {[gaze = policy.gaze](TrialOptions& trial) { trial.gaze = gaze; }, policy.name});
    }
    series.methods = [names](const LocalizerParams& ours) {
      std::vector<MethodMaker> methods;
      for (const std::string& name : names) methods.push_back(localizerMethod(name, ours));
      return methods;
    };
    series.drawn = names;
  }
  return variants;
}

nlohmann::json compareGaze(const ExperimentOptions& options) {
  nlohmann::json json;
  for (const TrialVariant& variant : gazeVariants(options)) {
    const TrialSeries& series = variant.series;
    json[variant.name] = runSeries(
        series, options.out, options.source, [&](const Comparison& comparison, nlohmann::json& figures) {
          const auto& records = comparison.records();
          for (std::size_t i = 1; i < records.size(); ++i) {
            figures[records[i].name]["against_" + records[0].name] = ratios(comparison, i, series.summary);
          }
        });
  }
  return json;
}

}  // namespace vismem
