#include "experiments/app/e5_travel.h"

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/experiment_files.h"
#include "experiments/app/trial_report.h"
#include "experiments/app/trial_run.h"

namespace vismem {
namespace {

/// Trials of --seed N have the seeds 1000 N + 1, 1000 N + 2 ... Those of N = 7 were used for tuning.
constexpr std::uint64_t kSeedsApart = 1000;
/// The corridor's ring once at a walk.
constexpr double kSeconds = 120.0;

struct Variant {
  const char* name;
  const char* title;
  int trials;
  bool rendered;
};
/// The setup `humanoid` brings slip, sway of a degree, latency of 0.1 s and half a degree of calibration
/// error.
constexpr Variant kVariants[] = {
    {"made_up", "humanoid in the corridor, made-up observations", 20, false},
    {"rendered", "humanoid in the corridor, rendered images", 10, true},
};

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const int trials = options.trials > 0 ? options.trials : variant.trials;
  const std::uint64_t first = kSeedsApart * options.seed + 1;
  std::optional<Comparison> comparison;
  for (int i = 0; i < trials; ++i) {
    TrialOptions trial;
    trial.world = "corridor";
    trial.setup = "humanoid";
    trial.seed = first + static_cast<std::uint64_t>(i);
    trial.events = 1;
    trial.event_s = kSeconds;
    trial.rendered = variant.rendered;
    TrialRun run(trial);
    if (!comparison) {
      const LocalizerParams& ours = run.params().localizer;
      comparison.emplace(
          std::string("travel_") + variant.name,
          text("E5 %s: %s; seeds %llu..%llu; from a known start unless said", variant.name, variant.title,
               static_cast<unsigned long long>(first), static_cast<unsigned long long>(first + trials - 1)),
          std::vector<MethodMaker>{localizerMethod("default", ours),
                                   localizerMethod("default_unknown_start", ours),
                                   localizerMethod("chapter", localizerPreset(LocalizationMode::kChapter)),
                                   monteCarloMethod("mcl_stock", stockMonteCarlo()),
                                   monteCarloMethod("mcl_tuned", tunedMonteCarlo())});
    }
    comparison->add(run.record(), run.params().map_edges, {"default", "chapter", "mcl_stock", "mcl_tuned"});
    if (i > 0) continue;
    for (const char* method : {"default", "default_unknown_start", "chapter"}) {
      comparison->drawLast(method, options.out / text("figure20_%s_%s.png", variant.name, method));
    }
  }
  SummaryParams params;
  params.kidnaps_only = false;
  params.within_s = kSeconds;
  nlohmann::json json = comparison->report(options.out, params);
  json["seeds"] = {first, first + trials - 1};
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
  json["took_s"] = spent.count();
  std::cerr << text("  took %.0f s\n", spent.count());
  return json;
}

}  // namespace

nlohmann::json travel(const ExperimentOptions& options) {
  nlohmann::json json;
  for (const Variant& variant : kVariants) {
    if (!options.variant.empty() && options.variant != variant.name) continue;
    json[variant.name] = runVariant(variant, options);
  }
  if (json.empty()) throw std::invalid_argument("E5 has no variant \"" + options.variant + "\"");
  return json;
}

}  // namespace vismem
