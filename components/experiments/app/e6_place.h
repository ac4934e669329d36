/// @file The worlds of E6, and the disturbances of the observations in each. See E6.
#pragma once

#include <string>

#include "experiments/app/experiments.h"
#include "experiments/app/trial_series.h"

namespace vismem {

/// A world of the kidnappings and of the gaze comparison.
struct E6Place {
  const char* name;   ///< of the variant
  const char* title;  ///< for people
  const char* world = "corridor_irregular";
  int trials = 25;  ///< by default
  bool rendered = false;
  Disturbance disturbance{};
  bool twins = false;  ///< a half turn about the origin maps the world onto its twin
};

inline const E6Place kIrregular{
    .name = "irregular", .title = "irregular corridor, synthetic observations", .trials = 50};
inline const E6Place kAliased{.name = "aliased",
                              .title = "corridor with two wings alike, synthetic observations",
                              .world = "corridor",
                              .trials = 50,
                              .twins = true};
inline const E6Place kRendered{
    .name = "rendered", .title = "irregular corridor, rendered images", .trials = 20, .rendered = true};
inline const E6Place kRenderedAliased{.name = "rendered_aliased",
                                      .title = "corridor with two wings alike, rendered images",
                                      .world = "corridor",
                                      .trials = 20,
                                      .rendered = true,
                                      .twins = true};

/// @return whether the options select the variant: by its name, or all.
inline bool isWanted(const E6Place& place, const ExperimentOptions& options) {
  return options.variant.empty() || options.variant == place.name;
}

/// The place's trials, without methods.
/// @param kind begins the title.
inline TrialSeries seriesAt(const E6Place& place, const std::string& kind, const ExperimentOptions& options) {
  TrialSeries series;
  series.name = place.name;
  series.title = kind + " " + place.name + ": " + place.title;
  series.trial.world = place.world;
  series.trial.rendered = place.rendered;
  series.trial.disturbance = place.disturbance;
  series.seed = options.seed;
  series.trials = options.trials > 0 ? options.trials : place.trials;
  series.only = options.methods;
  series.twins = place.twins;
  return series;
}

}  // namespace vismem
