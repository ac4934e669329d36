/// @file Novelty of an observation: a standing robot repeats what it saw. Pure. See L12.
#pragma once

#include <cstdint>
#include <vector>

#include "common/robot/samples.h"
#include "localization/core/observation/floor_observation.h"

namespace vismem {

/// Counts, in the odometry frame, how often points of each label were seen at each square of the floor.
/// Errors of the map and of labels are the same in every view of a place: repeated views are no new evidence.
/// *Single-threaded* (owner: RobustRaces).
class ObservationNovelty {
 public:
  ObservationNovelty();

  /// Counts the points as seen.
  /// @return weighted mean over the points of 1 / (1 + earlier views / 3), in (0, 1]; 1 without points.
  double assess(const FloorObservation& observation, const Pose2& T_odom_robot, StampUs stamp_us);
  /// Forgets all views, for a jump of odometry or of the robot.
  void reset();

 private:
  /// A square of the floor. Squares share table entries by hash; the latest one owns the entry.
  struct Square {
    std::uint64_t key = 0;
    StampUs stamp_us = 0;
    double views = 0.0;  ///< decayed count at stamp_us
  };
  double viewsOf(std::uint64_t key, StampUs stamp_us) const;

  std::vector<Square> squares_;
};

}  // namespace vismem
