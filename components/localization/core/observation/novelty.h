/// @file Novelty of an observation: points seen before at the same place of the floor repeat an old
/// observation. Pure. See L12.
#pragma once

#include <cstdint>
#include <vector>

#include "common/robot/samples.h"
#include "localization/core/observation/floor_observation.h"

namespace vismem {

struct NoveltyParams {
  /// Novelty is 1 / (1 + views / half_novelty_views); 0: always 1.
  double half_novelty_views = 3.0;
  double novelty_decay_s = 10.0;  ///< time constant of the exponential decay of a square's count of views
};

/// Counts, in the odometry frame, how often points of each label were seen at each square of the floor. An
/// object that the map lacks lies at one place in all images: its errors are one error, not one per image.
/// *Single-threaded* (owner: RobustRaces).
class ObservationNovelty {
 public:
  explicit ObservationNovelty(const NoveltyParams& params);

  /// Sets the novelty of the points and of the observation, then counts the points as seen.
  void assess(FloorObservation& observation, const Pose2& T_odom_robot, StampUs stamp_us);
  /// Forgets all views, for a jump of odometry or of the robot.
  void reset();

 private:
  /// A square of the floor. Squares share table entries by hash; the latest one owns the entry.
  struct Square {
    std::uint64_t key = 0;
    StampUs stamp_us = 0;
    float views = 0.0F;  ///< decayed count at stamp_us
  };
  static std::uint64_t keyOf(int label, std::int64_t x, std::int64_t y);
  Square& entryOf(std::uint64_t key) { return squares_[key % squares_.size()]; }
  double viewsOf(std::uint64_t key, StampUs stamp_us);

  NoveltyParams params_;
  std::vector<Square> squares_;
};

}  // namespace vismem
