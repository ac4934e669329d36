#include "experiments/app/e5_travel.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/experiment_files.h"
#include "experiments/app/trial_series.h"

namespace vismem {
namespace {

/// The corridor's ring once at a walk.
constexpr double kSeconds = 120.0;

struct Variant {
  const char* name;
  const char* title;
  int trials;
  bool rendered;
};
/// The setup `humanoid` has slip, body sway of a degree, latency of 0.1 s and half a degree of calibration
/// error.
constexpr Variant kVariants[] = {
    {"synthetic", "humanoid in the corridor, synthetic observations", 20, false},
    {"rendered", "humanoid in the corridor, rendered images", 10, true},
};

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options) {
  TrialSeries series;
  series.name = std::string("travel_") + variant.name;
  series.title = text("E5 %s: %s; from a known start unless said", variant.name, variant.title);
  series.trial.world = "corridor";
  series.trial.setup = "humanoid";
  series.trial.events = 1;
  series.trial.event_s = kSeconds;
  series.trial.rendered = variant.rendered;
  series.seed = options.seed;
  series.trials = options.trials > 0 ? options.trials : variant.trials;
  series.only = options.methods;
  series.methods = [](const LocalizerParams& ours) {
    return std::vector<MethodMaker>{
        localizerMethod("default", ours), localizerMethod("default_unknown_start", ours),
        localizerMethod("chapter", localizerPreset(LocalizationMode::kChapter)),
        monteCarloMethod("mcl_stock", stockMonteCarlo()), monteCarloMethod("mcl_tuned", tunedMonteCarlo())};
  };
  series.known_start = {"default", "chapter", "mcl_stock", "mcl_tuned"};
  series.drawn = {"default", "default_unknown_start", "chapter"};
  series.published = kPublishedTravel;
  series.summary.kidnaps_only = false;
  series.summary.within_s = kSeconds;
  return runSeries(series, options.out);
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
