#include "experiments/trials/trial_score.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kEvidenceGrace_s = 10.0;
constexpr double kChiSquare95 = 7.815;  // 95 % quantile, three degrees of freedom
constexpr double kChiSquare50 = 2.366;  // median, three degrees of freedom

/// @return empty when no race was ever at the true place.
std::optional<double> shareAlive(const std::vector<PoseEstimate>& estimates, const Trajectory& truth,
                                 const ScoreParams& params) {
  int since_first = 0;
  int alive = 0;
  for (const PoseEstimate& estimate : estimates) {
    const auto true_pose = poseAt(truth, estimate.stamp_us);
    if (!true_pose) continue;
    const bool there = std::any_of(estimate.races.begin(), estimate.races.end(), [&](const RaceReport& race) {
      return isRight(race.T_world_robot, *true_pose, params);
    });
    if (there || since_first > 0) ++since_first;
    if (there) ++alive;
  }
  if (since_first == 0) return std::nullopt;
  return static_cast<double>(alive) / since_first;
}

/// Squared Mahalanobis distance of the true pose from the estimate.
/// @return empty without a published pose; infinite for an invalid covariance.
std::optional<double> squaredMahalanobis(const PoseEstimate& estimate, const Trajectory& truth) {
  const auto true_pose = poseAt(truth, estimate.stamp_us);
  if (!true_pose || !estimate.T_world_robot) return std::nullopt;
  const Pose2& published = *estimate.T_world_robot;
  const Eigen::Vector3d error(true_pose->x - published.x, true_pose->y - published.y,
                              angleDifference(true_pose->theta, published.theta));
  const Eigen::LLT<Eigen::Matrix3d> root(estimate.P);
  if (root.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return root.matrixL().solve(error).squaredNorm();
}

void scoreCovariance(const std::vector<PoseEstimate>& estimates, const Trajectory& truth, StampUs from_us,
                     EventScore& score) {
  std::vector<double> squares;
  for (const PoseEstimate& estimate : estimates) {
    if (estimate.stamp_us < from_us) continue;
    if (const auto square = squaredMahalanobis(estimate, truth)) squares.push_back(*square);
  }
  if (squares.empty()) return;
  const auto inside =
      std::count_if(squares.begin(), squares.end(), [](double s) { return s <= kChiSquare95; });
  score.inside_reported = static_cast<double>(inside) / static_cast<double>(squares.size());
  score.error_over_reported = std::sqrt(*median(squares) / kChiSquare50);
}

using ValuesBySeed = std::map<std::uint64_t, std::vector<double>>;
using Statistic = std::function<std::optional<double>(const std::vector<double>&)>;

/// A statistic of the values with its bootstrap over seeds.
std::optional<Figure> figureOf(const ValuesBySeed& by_seed, const Statistic& statistic,
                               const SummaryParams& params) {
  std::vector<std::vector<double>> groups;
  std::vector<double> all;
  for (const auto& [seed, values] : by_seed) {
    groups.push_back(values);
    all.insert(all.end(), values.begin(), values.end());
  }
  const auto value = statistic(all);
  const auto interval = bootstrapInterval(groups, statistic, params.seed);
  if (!value || !interval) return std::nullopt;
  return Figure{*value, *interval};
}

/// Infinite for an event that did not recover.
double recoveryTime(const EventScore& event, double within_s) {
  const bool recovered = event.settled_after_s && *event.settled_after_s <= within_s;
  return recovered ? *event.settled_after_s : std::numeric_limits<double>::infinity();
}

}  // namespace

bool isRight(const Pose2& pose, const Pose2& truth, const ScoreParams& params) {
  return (pose.position() - truth.position()).norm() <= params.right_within_m &&
         std::abs(angleDifference(pose.theta, truth.theta)) <= params.right_within_rad;
}

Trajectory truthOfEvent(const Trial& trial, std::size_t event) {
  const StampUs from = trial.events_us.at(event);
  const bool is_last = event + 1 == trial.events_us.size();
  Trajectory truth;
  for (const StampedPose& pose : trial.truth) {
    if (pose.stamp_us >= from && (is_last || pose.stamp_us < trial.events_us[event + 1])) {
      truth.push_back(pose);
    }
  }
  return truth;
}

std::vector<EventScore> scoreEvents(const Trial& trial, const std::vector<PoseEstimate>& estimates,
                                    const ScoreParams& params) {
  std::vector<EventScore> scores;
  for (std::size_t event = 0; event < trial.events_us.size(); ++event) {
    const Trajectory truth = truthOfEvent(trial, event);
    if (truth.empty()) continue;
    EventScore score;
    score.seed = trial.seed;
    score.event = static_cast<int>(event);
    score.seconds = toSeconds(truth.back().stamp_us - truth.front().stamp_us);
    std::vector<PublishedPose> published;
    std::vector<PoseEstimate> here;
    for (const PoseEstimate& estimate : estimates) {
      if (estimate.stamp_us < truth.front().stamp_us || estimate.stamp_us > truth.back().stamp_us) continue;
      // Without new data an estimate is repeated: it counts once.
      if (!published.empty() && published.back().stamp_us >= estimate.stamp_us) continue;
      published.push_back({estimate.stamp_us, estimate.T_world_robot, estimate.reliability});
      here.push_back(estimate);
    }
    const LocalizationScore whole = scoreLocalization(published, truth, {}, params);
    score.settled_after_s = whole.settled_after_s;
    score.position_error_m = whole.position_error_m;
    score.heading_error_rad = whole.heading_error_rad;
    score.right_at_end = whole.recovered;
    score.true_alive = shareAlive(here, truth, params);
    if (score.settled_after_s) {
      scoreCovariance(here, truth, truth.front().stamp_us + toStampUs(*score.settled_after_s), score);
    }
    scores.push_back(score);
  }
  return scores;
}

std::optional<Figure> ratioOfQuantiles(const std::vector<EventScore>& a, const std::vector<EventScore>& b,
                                       double q, const SummaryParams& params) {
  // The bootstrap draws whole groups of one list of numbers: those of `b` have a negative sign.
  ValuesBySeed pairs;
  const auto add = [&](const std::vector<EventScore>& events, double sign) {
    for (const EventScore& event : events) {
      if (params.kidnaps_only && event.event == 0) continue;
      pairs[event.seed].push_back(sign * recoveryTime(event, params.within_s));
    }
  };
  add(a, 1.0);
  add(b, -1.0);
  const auto ratio = [q](const std::vector<double>& values) -> std::optional<double> {
    std::vector<double> times_a;
    std::vector<double> times_b;
    for (const double value : values) (std::signbit(value) ? times_b : times_a).push_back(std::abs(value));
    const auto above = quantile(times_a, q);
    const auto below = quantile(times_b, q);
    if (!above || !below || !std::isfinite(*above) || !std::isfinite(*below) || *below <= 0.0) {
      return std::nullopt;
    }
    return *above / *below;
  };
  return figureOf(pairs, ratio, params);
}

TrialSummary summarize(const std::vector<EventScore>& events, const SummaryParams& params) {
  TrialSummary summary;
  ValuesBySeed times, positions, headings, inside, over;
  int wrong = 0;
  int with_evidence = 0;
  int right_in_time = 0;
  std::vector<double> alive;
  for (const EventScore& event : events) {
    if (params.kidnaps_only && event.event == 0) continue;
    ++summary.events;
    const double recovery_s = recoveryTime(event, params.within_s);
    const bool recovered = std::isfinite(recovery_s);
    times[event.seed].push_back(recovery_s);
    if (event.true_alive) alive.push_back(*event.true_alive);
    // Evidence in the last seconds leaves no time to settle.
    if (event.evidence_after_s && *event.evidence_after_s + kEvidenceGrace_s <= event.seconds) {
      ++with_evidence;
      if (event.settled_after_s && *event.settled_after_s <= *event.evidence_after_s + kEvidenceGrace_s) {
        ++right_in_time;
      }
    }
    if (!recovered) continue;
    ++summary.recovered;
    if (!event.right_at_end) ++wrong;
    if (event.position_error_m) positions[event.seed].push_back(*event.position_error_m);
    if (event.heading_error_rad) headings[event.seed].push_back(*event.heading_error_rad);
    if (event.inside_reported) inside[event.seed].push_back(*event.inside_reported);
    if (event.error_over_reported) over[event.seed].push_back(*event.error_over_reported);
  }
  summary.seeds = static_cast<int>(times.size());
  if (summary.events == 0) return summary;
  summary.recovered_share = {static_cast<double>(summary.recovered) / summary.events,
                             wilsonInterval(summary.recovered, summary.events)};
  const auto figure = [&](const ValuesBySeed& by_seed, const Statistic& statistic) {
    return figureOf(by_seed, statistic, params);
  };
  const auto quantileOf = [](double q) {
    return [q](const std::vector<double>& values) { return quantile(values, q); };
  };
  summary.median_s = figure(times, quantileOf(0.5));
  summary.p90_s = figure(times, quantileOf(0.9));
  summary.position_error_m = figure(positions, mean);
  summary.heading_error_rad = figure(headings, mean);
  summary.inside_reported = figure(inside, mean);
  summary.error_over_reported = figure(over, mean);
  summary.median_position_error_m = figure(positions, quantileOf(0.5));
  if (summary.recovered > 0) summary.wrong_at_end = static_cast<double>(wrong) / summary.recovered;
  summary.true_alive = mean(alive);
  if (with_evidence > 0) {
    summary.right_after_evidence = Figure{static_cast<double>(right_in_time) / with_evidence,
                                          wilsonInterval(right_in_time, with_evidence)};
  }
  return summary;
}

}  // namespace vismem
