/// @file How well a run localized: when it settled, how large its errors were from then on. Pure. SPEC L11.
///
/// Definitions. The published pose is *right* when it is within 0.5 m and 15 degrees of the truth at its own
/// stamp. A run *settles* at the first right pose after which all are right for 2 s. Its errors are means
/// from there to the end of the run, losses included: a pose that goes wrong later counts with its whole
/// error, and a pose that is no longer published counts as if the last one still held, because that is what a
/// user of the pose has. A run has *recovered* when it settled, again after the last kidnapping, and ended
/// right.
#pragma once

#include <optional>
#include <vector>

#include "experiments/core/trajectory.h"

namespace vismem {

/// What localization said about one image.
struct PublishedPose {
  StampUs stamp_us = 0;
  std::optional<Pose2> T_world_robot;  ///< empty: it knows no place
  double reliability = 0.0;
};

struct ScoreParams {
  double right_within_m = 0.5;
  double right_within_rad = 0.2617993877991494;  ///< 15 degrees
  StampUs settle_us = 2 * kSecondUs;
  /// A silence longer than this ends a row of right poses, and is then sampled at this step with the last
  /// pose.
  StampUs max_silence_us = kSecondUs;
};

/// The error of one published pose.
struct PoseError {
  StampUs stamp_us = 0;
  std::optional<double> position_m;   ///< empty where no pose was published
  std::optional<double> heading_rad;  ///< >= 0
  double reliability = 0.0;
};

struct LocalizationScore {
  std::vector<PoseError> errors;  ///< one per published pose whose true place is known, by stamp
  StampUs start_us = 0;           ///< of the truth: settling counts from here
  std::optional<double> settled_after_s;
  std::optional<double> position_error_m;  ///< means from settling to the end; empty unless settled
  std::optional<double> heading_error_rad;
  bool recovered = false;
  int without_pose = 0;   ///< images without a pose after settling
  int without_truth = 0;  ///< published poses at stamps where the truth is not known
};

/// @param published      in order of their stamps.
/// @param truth          world -> robot.
/// @param kidnapped_us   stamps at which the robot was put elsewhere, in order.
LocalizationScore scoreLocalization(const std::vector<PublishedPose>& published, const Trajectory& truth,
                                    const std::vector<StampUs>& kidnapped_us = {},
                                    const ScoreParams& params = {});

/// Middle value; the mean of the two middle ones for an even count; empty for none. The input is reordered.
std::optional<double> median(std::vector<double> values);

}  // namespace vismem
