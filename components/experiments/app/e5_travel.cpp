#include "experiments/app/e5_travel.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/trial_series.h"

namespace vismem {
namespace {

/// The corridor's ring once at a walk.
constexpr double kSeconds = 120.0;

constexpr int kTrials = 10;
constexpr const char* kVariant = "rendered";

}  // namespace

nlohmann::json travel(const ExperimentOptions& options) {
  if (!options.variant.empty() && options.variant != kVariant) {
    throw std::invalid_argument("E5 has no variant \"" + options.variant + "\"");
  }
  TrialSeries series;
  series.name = std::string("travel_") + kVariant;
  series.title = "E5: humanoid in the corridor, rendered images; from a known start unless said";
  series.trial.world = "corridor";
  // Slip, body sway of a degree, latency of 0.1 s and half a degree of calibration error.
  series.trial.setup = "humanoid";
  series.trial.events = 1;
  series.trial.event_s = kSeconds;
  series.seed = options.seed;
  series.trials = options.trials > 0 ? options.trials : kTrials;
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
  nlohmann::json json;
  json[kVariant] = runSeries(series, options.out);
  return json;
}

}  // namespace vismem
