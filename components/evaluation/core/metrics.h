/// @file Localization metrics of a run: settling time, errors from settling on, recovery. Pure. See L11.
///
/// Definitions. The published pose is *right* when it is within 0.5 m and 15 degrees of the truth at its own
/// stamp. A run *settles* at the first right pose after which all are right for 2 s. Its errors are means
/// from settling to the end of the run, losses included. A pose that becomes wrong later counts with its
/// whole error. While no pose is published the last one counts, because a user of the pose has no other. A
/// run has *recovered* when it settled, again after the last kidnapping, and its last pose is right.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/angles.h"
#include "evaluation/core/trajectory.h"

namespace vismem {

/// The pose that localization published for one image.
struct PublishedPose {
  StampUs stamp_us = 0;
  std::optional<Pose2> T_world_robot;  ///< empty: none published
  double reliability = 0.0;
};

struct ScoreParams {
  double right_within_m = 0.5;
  double right_within_rad = degToRad(15.0);
  StampUs settle_us = 2 * kSecondUs;
  /// A longer time without a pose ends a row of right poses (sparse images need a longer one). The last pose
  /// is then sampled at this step.
  StampUs max_silence_us = kSecondUs;
  /// Motions under which the map looks the same (symmetriesOf): no observation decides between a pose and its
  /// twin, so that errors count against the nearer one. One motion holds from one kidnapping to the next.
  std::vector<Pose2> symmetries;
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
  /// Over all poses whose true place is known, before settling too; a missing pose is not right.
  std::optional<double> right_share;
  std::optional<double> median_position_error_m;  ///< of the published ones
  std::optional<double> median_heading_error_rad;
  int without_pose = 0;   ///< images without a pose after settling
  int without_truth = 0;  ///< published poses at stamps without a known truth
  bool is_twin = false;   ///< the last poses are right for a symmetric twin of the true place
};

/// @param published      in order of their stamps.
/// @param truth          world -> robot.
/// @param kidnapped_us   stamps of the kidnappings, in order.
LocalizationScore scoreLocalization(const std::vector<PublishedPose>& published, const Trajectory& truth,
                                    const std::vector<StampUs>& kidnapped_us = {},
                                    const ScoreParams& params = {});

/// Middle value; the mean of the two middle ones for an even count; empty for none. The input is reordered.
std::optional<double> median(std::vector<double> values);

}  // namespace vismem
