#include "evaluation/core/trajectory.h"

#include <algorithm>

namespace vismem {
namespace {

Trajectory::const_iterator firstNotBefore(const Trajectory& trajectory, StampUs stamp_us) {
  return std::lower_bound(trajectory.begin(), trajectory.end(), stamp_us,
                          [](const StampedPose& p, StampUs stamp) { return p.stamp_us < stamp; });
}

}  // namespace

bool append(Trajectory& trajectory, const StampedPose& pose) {
  if (!trajectory.empty() && pose.stamp_us <= trajectory.back().stamp_us) return false;
  trajectory.push_back(pose);
  return true;
}

std::optional<Pose2> poseAt(const Trajectory& trajectory, StampUs stamp_us, StampUs max_gap_us) {
  const auto after = firstNotBefore(trajectory, stamp_us);
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp_us == stamp_us) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const StampUs gap = after->stamp_us - before->stamp_us;
  if (gap > max_gap_us) return std::nullopt;
  const double fraction = static_cast<double>(stamp_us - before->stamp_us) / static_cast<double>(gap);
  return interpolate(before->pose, after->pose, fraction);
}

Trajectory transform(const Pose2& T_a_b, const Trajectory& trajectory_b) {
  Trajectory result = trajectory_b;
  for (StampedPose& p : result) p.pose = T_a_b * p.pose;
  return result;
}

double pathLength(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].pose.position() - trajectory[i - 1].pose.position()).norm();
  }
  return length;
}

}  // namespace vismem
