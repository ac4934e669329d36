#include "evaluation/core/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

struct Deviation {
  double position_m = 0.0;
  double heading_rad = 0.0;
};

Deviation deviation(const Pose2& estimate, const Pose2& truth) {
  return {(estimate.position() - truth.position()).norm(),
          std::abs(angleDifference(estimate.theta, truth.theta))};
}

bool isRight(const PoseError& error, const ScoreParams& params) {
  return error.position_m && *error.position_m <= params.right_within_m &&
         *error.heading_rad <= params.right_within_rad;
}

/// @return index of the first right pose at or after `from_us` after which all are right for the settling
/// time.
std::optional<std::size_t> findSettled(const std::vector<PoseError>& errors, StampUs from_us,
                                       const ScoreParams& params) {
  std::optional<std::size_t> begin;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i].stamp_us < from_us) continue;
    if (!isRight(errors[i], params)) {
      begin.reset();
      continue;
    }
    if (!begin || errors[i].stamp_us - errors[i - 1].stamp_us > params.max_silence_us) begin = i;
    if (errors[i].stamp_us - errors[*begin].stamp_us >= params.settle_us) return begin;
  }
  return std::nullopt;
}

/// Sums the errors of the pose that a user had: of each published pose, and of the last one while none came.
class HeldPoseErrors {
 public:
  HeldPoseErrors(const Trajectory& truth, StampUs step_us) : truth_(truth), step_us_(step_us) {}

  void add(StampUs stamp_us, const std::optional<Pose2>& pose) {
    fillSilence(stamp_us);
    if (pose) held_ = pose;
    addHeld(stamp_us);
    last_us_ = stamp_us;
  }
  void fillSilence(StampUs until_us) {
    if (!last_us_ || until_us - *last_us_ <= step_us_) return;
    for (StampUs t = *last_us_ + step_us_; t < until_us; t += step_us_) addHeld(t);
  }
  double meanPosition() const { return position_m_ / count_; }
  double meanHeading() const { return heading_rad_ / count_; }
  bool any() const { return count_ > 0; }

 private:
  void addHeld(StampUs stamp_us) {
    const std::optional<Pose2> truth = poseAt(truth_, stamp_us);
    if (!held_ || !truth) return;
    const Deviation d = deviation(*held_, *truth);
    position_m_ += d.position_m;
    heading_rad_ += d.heading_rad;
    ++count_;
  }

  const Trajectory& truth_;
  StampUs step_us_;
  std::optional<Pose2> held_;
  std::optional<StampUs> last_us_;
  double position_m_ = 0.0;
  double heading_rad_ = 0.0;
  int count_ = 0;
};

/// Mean distance of poses to the truth after a motion of all of them; infinite without a common stamp.
double meanDistance(std::span<const PublishedPose> poses, const Trajectory& truth, const Pose2& motion) {
  double sum_m = 0.0;
  int count = 0;
  for (const PublishedPose& p : poses) {
    const std::optional<Pose2> true_pose = p.T_world_robot ? poseAt(truth, p.stamp_us) : std::nullopt;
    if (!true_pose) continue;
    sum_m += deviation(motion * *p.T_world_robot, *true_pose).position_m;
    ++count;
  }
  return count > 0 ? sum_m / count : std::numeric_limits<double>::infinity();
}

/// Moves the poses between two kidnappings by the symmetry that brings them nearest to the truth.
/// @return whether the last of them moved.
bool moveToNearestTwin(std::vector<PublishedPose>& published, const Trajectory& truth,
                       const std::vector<StampUs>& kidnapped_us, const std::vector<Pose2>& symmetries) {
  bool moved = false;
  auto begin = published.begin();
  for (std::size_t i = 0; i <= kidnapped_us.size(); ++i) {
    const auto end = i == kidnapped_us.size()
                         ? published.end()
                         : std::find_if(begin, published.end(), [&](const PublishedPose& p) {
                             return p.stamp_us >= kidnapped_us[i];
                           });
    const std::span<const PublishedPose> part(begin, end);
    Pose2 best;
    double least_m = meanDistance(part, truth, best);
    for (const Pose2& motion : symmetries) {
      const double distance_m = meanDistance(part, truth, motion);
      if (distance_m < least_m) std::tie(best, least_m) = std::pair(motion, distance_m);
    }
    moved = best != Pose2{};
    for (auto p = begin; moved && p != end; ++p) {
      if (p->T_world_robot) p->T_world_robot = best * *p->T_world_robot;
    }
    begin = end;
  }
  return moved;
}

/// Shares and medians over all errors.
void addWholeRun(LocalizationScore& score, const ScoreParams& params) {
  if (score.errors.empty()) return;
  std::vector<double> position_m;
  std::vector<double> heading_rad;
  std::ptrdiff_t right = 0;
  for (const PoseError& error : score.errors) {
    if (isRight(error, params)) ++right;
    if (!error.position_m) continue;
    position_m.push_back(*error.position_m);
    heading_rad.push_back(*error.heading_rad);
  }
  score.right_share = static_cast<double>(right) / static_cast<double>(score.errors.size());
  score.median_position_error_m = median(std::move(position_m));
  score.median_heading_error_rad = median(std::move(heading_rad));
}

}  // namespace

LocalizationScore scoreLocalization(const std::vector<PublishedPose>& poses, const Trajectory& truth,
                                    const std::vector<StampUs>& kidnapped_us, const ScoreParams& params) {
  LocalizationScore score;
  if (truth.empty()) {
    score.without_truth = static_cast<int>(poses.size());
    return score;
  }
  std::vector<PublishedPose> published = poses;
  score.is_twin = moveToNearestTwin(published, truth, kidnapped_us, params.symmetries);
  score.start_us = truth.front().stamp_us;
  for (const PublishedPose& p : published) {
    const std::optional<Pose2> true_pose = poseAt(truth, p.stamp_us);
    if (!true_pose) {
      ++score.without_truth;
      continue;
    }
    PoseError error{p.stamp_us, {}, {}, p.reliability};
    if (p.T_world_robot) {
      const Deviation d = deviation(*p.T_world_robot, *true_pose);
      error.position_m = d.position_m;
      error.heading_rad = d.heading_rad;
    }
    score.errors.push_back(error);
  }
  addWholeRun(score, params);

  const auto settled = findSettled(score.errors, score.start_us, params);
  if (!settled) return score;
  const StampUs settled_us = score.errors[*settled].stamp_us;
  score.settled_after_s = toSeconds(settled_us - score.start_us);

  HeldPoseErrors held(truth, params.max_silence_us);
  for (const PublishedPose& p : published) {
    if (p.stamp_us < settled_us || p.stamp_us > truth.back().stamp_us) continue;
    held.add(p.stamp_us, p.T_world_robot);
    if (!p.T_world_robot) ++score.without_pose;
  }
  held.fillSilence(truth.back().stamp_us);
  if (held.any()) {
    score.position_error_m = held.meanPosition();
    score.heading_error_rad = held.meanHeading();
  }

  const StampUs last_kidnap = kidnapped_us.empty() ? score.start_us : kidnapped_us.back();
  const bool ended_speaking = truth.back().stamp_us - score.errors.back().stamp_us <= params.max_silence_us;
  score.recovered = findSettled(score.errors, last_kidnap, params).has_value() && ended_speaking &&
                    isRight(score.errors.back(), params);
  return score;
}

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace vismem
