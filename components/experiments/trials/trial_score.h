/// @file Scores of a method in trials: of each event, and over all events with 95 % intervals. Pure.
/// The definitions of settled, recovered and of errors are those of metrics.h. See L11, E5, E6.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/core/metrics.h"
#include "experiments/trials/intervals.h"
#include "experiments/trials/trial.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// @return whether a pose is right by ScoreParams.
bool isRight(const Pose2& pose, const Pose2& truth, const ScoreParams& params = {});

/// The score of one start or kidnapping.
struct EventScore {
  std::uint64_t seed = 0;
  int event = 0;  ///< 0: the start of the run, with an unknown pose
  double seconds = 0.0;
  /// From the event to the first right pose after which all are right for 2 s; empty: never.
  std::optional<double> settled_after_s;
  std::optional<double> position_error_m;  ///< from then to the event's end, losses included
  std::optional<double> heading_error_rad;
  bool right_at_end = false;
  /// Share of images with a race at the true place, after the first such image.
  std::optional<double> true_alive;
  /// Share of images after settling whose true pose lies inside the 95 % region of the reported covariance. A
  /// consistent filter has 0.95; a smaller share is overconfident, a larger one pessimistic.
  std::optional<double> inside_reported;
  /// Median error of these images in reported standard deviations, over that of a consistent filter. 2:
  /// errors are twice as large as reported.
  std::optional<double> error_over_reported;
  /// Time of sufficient evidence for the true place against its twin (TwinEvidence); empty: never, or no
  /// twin.
  std::optional<double> evidence_after_s;
};

/// @param estimates one per update of the trial.
std::vector<EventScore> scoreEvents(const Trial& trial, const std::vector<PoseEstimate>& estimates,
                                    const ScoreParams& params = {});

/// A figure over events with its 95 % interval.
struct Figure {
  double value = 0.0;  ///< infinite: too many events failed for this quantile
  Interval interval;
};

struct SummaryParams {
  double within_s = 60.0;    ///< an event has recovered when it settled within this
  bool kidnaps_only = true;  ///< false: starts too
  std::uint64_t seed = 1;    ///< of the bootstrap
};

struct TrialSummary {
  int events = 0;
  int seeds = 0;
  int recovered = 0;
  Figure recovered_share;  ///< Wilson
  /// Bootstrap over seeds; an event that did not recover counts as infinitely late.
  std::optional<Figure> median_s;
  std::optional<Figure> p90_s;
  /// Means over the events that recovered, of their means.
  std::optional<Figure> position_error_m;
  std::optional<Figure> heading_error_rad;
  std::optional<Figure> median_position_error_m;  ///< median over events
  double wrong_at_end = 0.0;                      ///< share of the recovered events that ended wrong
  /// Means over the events that recovered.
  std::optional<Figure> inside_reported;
  std::optional<Figure> error_over_reported;
  /// Twins: share of images with the true place among the races once it was, and share of events with
  /// evidence that had settled 10 s after it.
  std::optional<double> true_alive;
  std::optional<Figure> right_after_evidence;
};

/// Ratio of the quantiles of the recovery times of `a` and `b`, both of the same seeds, with the bootstrap's
/// interval over pairs of runs.
/// @param params its `within_s` and `kidnaps_only` apply.
/// @return empty when either quantile is infinite.
std::optional<Figure> ratioOfQuantiles(const std::vector<EventScore>& a, const std::vector<EventScore>& b,
                                       double q, const SummaryParams& params = {});

TrialSummary summarize(const std::vector<EventScore>& events, const SummaryParams& params = {});

}  // namespace vismem
