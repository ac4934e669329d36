#include "experiments/app/e6_kidnapping.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/e6_gaze.h"
#include "experiments/app/e6_place.h"

namespace vismem {
namespace {

enum class Methods { kAll, kDefaultAndMcl, kAblation };

struct Variant {
  E6Place place;
  Methods methods = Methods::kAll;
  double blackout_s = 0.0;
};

constexpr double kBlackoutFrom_s = 30.0;
const Disturbance kFalse30{0.3, 0.0, 3.0};
const Disturbance kFalse50{0.5, 0.0, 3.0};
const Disturbance kLost50{0.0, 0.5, 3.0};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {kRendered},
      {kRenderedAliased},
      {{.name = "rendered_false30",
        .title = "irregular corridor, 30 % false segments added to the detected ones",
        .disturbance = kFalse30}},
      {{.name = "rendered_false50",
        .title = "irregular corridor, 50 % false segments added to the detected ones",
        .disturbance = kFalse50}},
      {{.name = "rendered_lost50",
        .title = "irregular corridor, half of the detected segments lost",
        .disturbance = kLost50}},
      {{.name = "rendered_blackout",
        .title = "irregular corridor, nothing seen from 30 to 40 s after each event"},
       Methods::kAll,
       10.0},
      {{.name = "rendered_ablation", .title = "irregular corridor, parts of the default mode off"},
       Methods::kAblation},
      {{.name = "rendered_ablation_false",
        .title = "irregular corridor, 30 % false segments, parts of the default mode off",
        .disturbance = kFalse30},
       Methods::kAblation},
      {{.name = "rendered_room", .title = "room", .world = "room"}, Methods::kDefaultAndMcl},
      {{.name = "rendered_field", .title = "football field", .world = "field_6x4", .twins = true},
       Methods::kDefaultAndMcl},
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
  TrialSeries series = seriesAt(variant.place, "E6", options);
  series.trial.blackout_from_s = kBlackoutFrom_s;
  series.trial.blackout_s = variant.blackout_s;
  series.methods = [&variant](const LocalizerParams& ours) { return methodsOf(variant, ours); };
  series.published = kPublishedKidnapping;
  series.drawn = {"default", "chapter"};
  return runSeries(series, options.out);
}

}  // namespace

nlohmann::json kidnapping(const ExperimentOptions& options) {
  if (!options.gaze.empty()) return compareGaze(options);
  nlohmann::json json;
  for (const Variant& variant : variants()) {
    if (!isWanted(variant.place, options)) continue;
    json[variant.place.name] = runVariant(variant, options);
  }
  if (json.empty()) throw std::invalid_argument("E6 has no variant \"" + options.variant + "\"");
  return json;
}

}  // namespace vismem
