#include "experiments/app/trial_variants.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/config/config_reader.h"
#include "common/config/project_file.h"
#include "common/config/text_format.h"
#include "experiments/app/e6_gaze.h"

namespace vismem {
namespace {

/// `ablations` is one method for each part of the default mode that is off.
const std::vector<std::string> kMethods{
    "default", "default_unknown_start", "chapter", "mcl_stock", "mcl_tuned", "ablations"};

std::vector<MethodMaker> makersOf(const std::vector<std::string>& names, const LocalizerParams& ours) {
  std::vector<MethodMaker> makers;
  for (const std::string& name : names) {
    if (name == "ablations") {
      for (const Ablation& one : ablations(ours)) makers.push_back(localizerMethod(one.name, one.params));
    } else if (name.starts_with("mcl")) {
      makers.push_back(monteCarloMethod(name, name == "mcl_tuned" ? tunedMonteCarlo() : stockMonteCarlo()));
    } else {
      makers.push_back(
          localizerMethod(name, name == "chapter" ? localizerPreset(LocalizationMode::kChapter) : ours));
    }
  }
  return makers;
}

/// Names of methods between blanks.
std::vector<std::string> methodsOf(ConfigReader& config, const char* key, const std::string& fallback) {
  std::vector<std::string> names;
  std::istringstream words(config.text(key, fallback));
  for (std::string name; words >> name;) {
    if (std::find(kMethods.begin(), kMethods.end(), name) == kMethods.end()) {
      config.problem(key, "must be some of " + joined(kMethods, " "));
      break;
    }
    names.push_back(name);
  }
  return names;
}

TrialSeries readSeries(ConfigReader config) {
  enum class Published { kNone, kTravel, kKidnapping };
  TrialSeries series;
  TrialOptions& trial = series.trial;
  series.title = config.requiredText("Title", "what the variant is, for people");
  trial.world = config.text("World", "corridor_irregular");
  trial.setup = config.text("Setup", trial.setup);
  trial.events = static_cast<int>(config.integer("Events", trial.events, 1, 1000));
  trial.event_s = config.real("Event_s", trial.event_s, 1.0, 3600.0);
  Disturbance& disturbance = trial.disturbance;
  disturbance.false_share = config.real("FalseShare", disturbance.false_share, 0.0, 0.95);
  disturbance.lost_share = config.real("LostShare", disturbance.lost_share, 0.0, 1.0);
  disturbance.clutter_s = config.real("Clutter_s", disturbance.clutter_s, 0.1, 600.0);
  trial.blackout_from_s = config.real("Blackout.From_s", 30.0, 0.0, 3600.0);
  trial.blackout_s = config.real("Blackout.Length_s", trial.blackout_s, 0.0, 3600.0);
  series.trials = static_cast<int>(config.integer("Trials", 20, 1, 10'000));
  series.twins = config.boolean("Twins", series.twins);
  const auto names = methodsOf(config, "Methods", "default chapter mcl_stock mcl_tuned");
  series.methods = [names](const LocalizerParams& ours) { return makersOf(names, ours); };
  series.known_start = methodsOf(config, "KnownStart", "");
  series.drawn = methodsOf(config, "Drawn", "default chapter");
  switch (config.choice(
      "Published", Published::kKidnapping,
      {{"none", Published::kNone}, {"travel", Published::kTravel}, {"kidnapping", Published::kKidnapping}})) {
    case Published::kNone:
      break;
    case Published::kTravel:
      series.published = kPublishedTravel;
      break;
    case Published::kKidnapping:
      series.published = kPublishedKidnapping;
  }
  series.summary.within_s = trial.event_s;
  // A run of one event has only its start.
  series.summary.kidnaps_only = trial.events > 1;
  return series;
}

}  // namespace

std::vector<TrialVariant> readTrialVariants(const Properties& properties, const std::string& experiment) {
  ConfigReader config(properties);
  const std::string group = experiment + ".Variant";
  std::vector<TrialVariant> variants;
  for (const std::string& name : config.children(group)) {
    TrialSeries series = readSeries(config.group(group + "." + name));
    series.name = name;
    series.title = experiment + " " + name + ": " + series.title;
    variants.push_back({name, std::move(series)});
  }
  config.finish();
  return variants;
}

namespace {

std::filesystem::path fileOfVariants(const std::string& experiment, const ExperimentOptions& options) {
  return options.variants.empty() ? projectFile("cfg/experiments/" + experiment + ".variants")
                                  : options.variants;
}

/// The content of a file that can be read; else empty, so that reading it reports why.
std::string textOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::vector<TrialVariant> chosenTrialVariants(const std::string& experiment,
                                              const ExperimentOptions& options) {
  const auto file = fileOfVariants(experiment, options);
  const std::string content = options.variants_text.empty() ? textOf(file) : options.variants_text;
  auto variants = readTrialVariants(
      content.empty() ? Properties::load(file.string()) : Properties::parse(content, file.string()),
      experiment);
  const std::string known = joined(variants, ", ", &TrialVariant::name);
  if (!options.variant.empty()) {
    std::erase_if(variants, [&](const TrialVariant& one) { return one.name != options.variant; });
  }
  if (variants.empty()) {
    throw ConfigError({experiment + " has no variant \"" + options.variant + "\" (there are " + known + ")"});
  }
  for (TrialVariant& variant : variants) {
    variant.series.seed = options.seed;
    variant.series.only = options.methods;
    if (options.trials > 0) variant.series.trials = options.trials;
    const nlohmann::json origin{{"experiment", experiment},   {"variant", variant.name},
                                {"methods", options.methods}, {"gaze", options.gaze},
                                {"file", file.string()},      {"text", content}};
    variant.series.origin = origin.dump();
  }
  return variants;
}

nlohmann::json runTrialVariants(const std::string& experiment, const std::string& files,
                                const ExperimentOptions& options) {
  nlohmann::json json;
  for (TrialVariant& variant : chosenTrialVariants(experiment, options)) {
    variant.series.name = files + variant.name;
    json[variant.name] = runSeries(variant.series, options.out, options.source);
  }
  return json;
}

TrialSeries seriesFrom(const std::string& origin) {
  const auto json = nlohmann::json::parse(origin);
  ExperimentOptions options;
  options.variant = json.at("variant").get<std::string>();
  options.methods = json.at("methods").get<std::vector<std::string>>();
  options.gaze = json.at("gaze").get<std::string>();
  options.variants = json.at("file").get<std::string>();
  options.variants_text = json.at("text").get<std::string>();
  // Whoever gives out work must not read this machine's files by their error messages.
  if (options.variants_text.empty()) throw std::invalid_argument("no text of variants");
  const auto experiment = json.at("experiment").get<std::string>();
  auto variants =
      experiment == kGazeExperiment ? gazeVariants(options) : chosenTrialVariants(experiment, options);
  return std::move(variants.front().series);
}

}  // namespace vismem
