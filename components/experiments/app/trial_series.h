/// @file Many trials of one kind with every method, and their results on disk after each trial. See E5, E6.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/app/experiments.h"
#include "experiments/app/trial_report.h"
#include "experiments/app/trial_run.h"
#include "experiments/trials/published_results.h"

namespace vismem {

/// A record of each trial, and the methods that get it.
struct TrialRecording {
  /// Changes the series' trial for this record; may be empty.
  std::function<void(TrialOptions&)> change;
  /// One of the series' methods; empty: all of them.
  std::string method;
};

struct TrialSeries {
  std::string name;    ///< of the files: "irregular"
  std::string origin;  ///< makes the same series elsewhere: seriesFrom(), trial_variants.h
  std::string title;   ///< for people: "E6 irregular: ..."; the seeds are added
  TrialOptions trial;  ///< its seed is set
  std::uint64_t seed = 1;
  int trials = 1;
  /// @param ours the default mode as the setup configures it.
  std::function<std::vector<MethodMaker>(const LocalizerParams& ours)> methods;
  std::vector<std::string> only;  ///< of the methods, by name; empty: all
  std::vector<TrialRecording> recordings{{}};
  std::vector<std::string> known_start;  ///< methods that get the true pose at the first event
  /// Methods whose error over time in the first trial is drawn, as NAME_METHOD.png.
  std::vector<std::string> drawn;
  std::optional<PublishedResult> published;  ///< of the chapter, for the same experiment
  bool twins = false;                        ///< a half turn about the origin maps the world onto its twin
  SummaryParams summary;
};

/// Trials of `experiment --seed N` have the seeds 1000 N + 1, 1000 N + 2 and so on. N = 7 was used for
/// tuning.
inline constexpr std::uint64_t kSeedsApart = 1000;

/// The seeds of a series' trials.
std::vector<std::uint64_t> seedsOf(const TrialSeries& series);

/// What happens meanwhile; either may be empty.
struct TrialWatch {
  std::function<void()> look;  ///< after each image and update; what it throws ends the trial
  std::function<void(const TrialOutcome&)> part;  ///< after each method
};

/// Runs one trial of a series.
/// @param so_far an outcome of the same trial that lacks methods: only these are run.
TrialOutcome runTrial(const TrialSeries& series, std::uint64_t seed, TrialOutcome so_far = {},
                      const TrialWatch& watch = {});

/// Compares the methods over all trials. After each of them NAME_events.csv and NAME.json hold all results so
/// far.
/// @param source empty: this process runs the trials.
/// @param add_figures adds the figures of this series only to the JSON at the end; may be empty.
/// @return the figures, with "seeds" and "took_s".
/// @throws ConfigError when `only` names an unknown method.
nlohmann::json runSeries(const TrialSeries& series, const std::filesystem::path& out,
                         const TrialSource& source = {},
                         const std::function<void(const Comparison&, nlohmann::json&)>& add_figures = {});

}  // namespace vismem
