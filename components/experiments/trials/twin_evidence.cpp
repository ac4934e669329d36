#include "experiments/trials/twin_evidence.h"

#include <algorithm>

#include "localization/core/likelihood/robust_likelihood.h"

namespace vismem {

std::optional<double> evidenceAfter(const Trial& trial, std::size_t event, const Pose2& T_world_twin,
                                    const MapIndex& map, const TwinEvidenceParams& params) {
  const Trajectory truth = truthOfEvent(trial, event);
  if (truth.empty()) return std::nullopt;
  ObservationParams observation;
  observation.effective_points = 1e9;  // weights stay metres of line
  const auto distanceAt = [&](const FloorPoint& point, const Pose2& pose) {
    const auto nearest =
        map.nearest(point.label, transform(pose, point.p_robot), point.direction_robot + pose.theta);
    return nearest ? nearest->distance_m : 1e9;
  };
  double seen_m = 0.0;
  StampUs last_us = 0;
  for (const MemoryUpdate& update : trial.updates) {
    const StampUs stamp_us = update.analysis->stamp_us;
    const auto pose = poseAt(truth, stamp_us);
    if (!pose || stamp_us == last_us) continue;
    last_us = stamp_us;
    const Pose2 twin = T_world_twin * *pose;
    double here_m = 0.0;
    for (const FloorPoint& point : observeImage(*update.analysis, map, observation).points) {
      if (distanceAt(point, *pose) > params.on_map_m || distanceAt(point, twin) <= params.off_map_m) continue;
      here_m += point.weight / kPointsPerMetre;
    }
    seen_m += std::min(here_m, params.most_per_image_m);
    if (seen_m >= params.enough_m) return toSeconds(stamp_us - truth.front().stamp_us);
  }
  return std::nullopt;
}

}  // namespace vismem
