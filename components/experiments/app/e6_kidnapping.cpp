#include "experiments/app/e6_kidnapping.h"

#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/e6_gaze.h"
#include "experiments/app/experiment_files.h"
#include "experiments/app/trial_series.h"

namespace vismem {
namespace {

enum class Methods { kAll, kDefaultAndMcl, kAblation };

struct Variant {
  const char* name;
  const char* title;
  const char* world;
  int trials;
  Methods methods;
  bool rendered;
  Disturbance disturbance;
  double blackout_s;
  bool twins;  ///< a half turn about the origin maps the world onto its twin
};

constexpr double kBlackoutFrom_s = 30.0;

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {"irregular",
       "irregular corridor, made-up observations",
       "corridor_irregular",
       50,
       Methods::kAll,
       false,
       {},
       0.0,
       false},
      {"aliased",
       "corridor with two wings alike, made-up observations",
       "corridor",
       50,
       Methods::kAll,
       false,
       {},
       0.0,
       true},
      {"rendered",
       "irregular corridor, rendered images",
       "corridor_irregular",
       20,
       Methods::kAll,
       true,
       {},
       0.0,
       false},
      {"rendered_aliased",
       "corridor with two wings alike, rendered images",
       "corridor",
       20,
       Methods::kAll,
       true,
       {},
       0.0,
       true},
      {"false30",
       "irregular corridor, 30 % false segments",
       "corridor_irregular",
       25,
       Methods::kAll,
       false,
       {0.3, 0.0, 3.0},
       0.0,
       false},
      {"false50",
       "irregular corridor, 50 % false segments",
       "corridor_irregular",
       25,
       Methods::kAll,
       false,
       {0.5, 0.0, 3.0},
       0.0,
       false},
      {"lost50",
       "irregular corridor, half of the segments lost",
       "corridor_irregular",
       25,
       Methods::kAll,
       false,
       {0.0, 0.5, 3.0},
       0.0,
       false},
      {"blackout",
       "irregular corridor, nothing seen from 30 to 40 s after each event",
       "corridor_irregular",
       25,
       Methods::kAll,
       false,
       {},
       10.0,
       false},
      {"ablation",
       "irregular corridor, parts of the default mode off",
       "corridor_irregular",
       25,
       Methods::kAblation,
       false,
       {},
       0.0,
       false},
      {"ablation_false",
       "irregular corridor, 30 % false segments, parts of the default mode off",
       "corridor_irregular",
       25,
       Methods::kAblation,
       false,
       {0.3, 0.0, 3.0},
       0.0,
       false},
      {"room", "room, made-up observations", "room", 25, Methods::kDefaultAndMcl, false, {}, 0.0, false},
      {"field",
       "football field, made-up observations",
       "field_6x4",
       25,
       Methods::kDefaultAndMcl,
       false,
       {},
       0.0,
       true},
  };
  return all;
}

std::vector<MethodMaker> methodsOf(const Variant& variant, const LocalizerParams& ours) {
  std::vector<MethodMaker> methods{localizerMethod("default", ours)};
  if (variant.methods == Methods::kAblation) {
    for (const Ablation& one : ablations(ours)) methods.push_back(localizerMethod(one.name, one.params));
    return methods;
  }
  if (variant.methods == Methods::kAll) {
    methods.push_back(localizerMethod("chapter", localizerPreset(LocalizationMode::kChapter)));
  }
  methods.push_back(monteCarloMethod("mcl_stock", stockMonteCarlo()));
  methods.push_back(monteCarloMethod("mcl_tuned", tunedMonteCarlo()));
  return methods;
}

nlohmann::json runVariant(const Variant& variant, const ExperimentOptions& options) {
  TrialSeries series;
  series.name = variant.name;
  series.title = text("E6 %s: %s", variant.name, variant.title);
  series.trial.world = variant.world;
  series.trial.rendered = variant.rendered;
  series.trial.disturbance = variant.disturbance;
  series.trial.blackout_from_s = kBlackoutFrom_s;
  series.trial.blackout_s = variant.blackout_s;
  series.seed = options.seed;
  series.trials = options.trials > 0 ? options.trials : variant.trials;
  series.methods = [&variant](const LocalizerParams& ours) { return methodsOf(variant, ours); };
  series.drawn = {"default", "chapter"};
  series.twins = variant.twins;
  return runSeries(series, options.out);
}

/// How the made-up observations compare with what images give, in the same trials.
nlohmann::json compareVision(const ExperimentOptions& options) {
  nlohmann::json json;
  const int trials = options.trials > 0 ? options.trials : 3;
  for (const char* world : {"corridor_irregular", "corridor"}) {
    for (const bool rendered : {true, false}) {
      VisionStatistics all;
      for (int i = 0; i < trials; ++i) {
        TrialOptions trial_options;
        trial_options.world = world;
        trial_options.seed = kSeedsApart * options.seed + 1 + static_cast<std::uint64_t>(i);
        trial_options.rendered = rendered;
        trial_options.events = 2;
        TrialRun run(trial_options);
        run.measureVision(&all);
        run.record();
      }
      const char* name = rendered ? "rendered" : "made_up";
      json[world][name] = toJson(all);
      std::cerr << "E6 vision: " << world << ", " << name << "\n" << json[world][name].dump(1) << "\n";
    }
  }
  return json;
}

}  // namespace

nlohmann::json kidnapping(const ExperimentOptions& options) {
  if (!options.gaze.empty()) return compareGaze(options);
  nlohmann::json json;
  for (const Variant& variant : variants()) {
    if (!options.variant.empty() && options.variant != variant.name) continue;
    json[variant.name] = runVariant(variant, options);
  }
  if (options.variant.empty() || options.variant == "vision") json["vision"] = compareVision(options);
  if (json.empty()) throw std::invalid_argument("E6 has no variant \"" + options.variant + "\"");
  return json;
}

}  // namespace vismem
