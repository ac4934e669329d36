/// @file How much of an observation was not seen before: what lies where it lay tells the same again. Pure.
/// DESIGN 9 part 4.
#pragma once

#include <cstdint>
#include <vector>

#include "common/robot/samples.h"
#include "localization/core/robust_observation.h"

namespace vismem {

/// Remembers in odometry where points of each label were seen, and how often. A thing that is not in the map
/// lies there in one image after the other: without this, it would speak against the true place in each of
/// them, as if it were many things. *Single-threaded* (owner: the strategy).
class ObservationNews {
 public:
  explicit ObservationNews(const RobustParams& params);

  /// Sets the points' and the observation's `news`, then takes them as seen.
  void weigh(RobustObservation& observation, const Pose2& T_odom_robot, StampUs stamp_us);
  /// Odometry jumped: its places mean others now.
  void clear();

 private:
  /// A square of the floor; the table has one entry for many squares, of which the last one seen has it.
  struct Square {
    std::uint64_t key = 0;
    StampUs stamp_us = 0;
    float times = 0.0F;  ///< that it was seen, of which what is long ago counts less
  };
  static std::uint64_t keyOf(int label, std::int64_t x, std::int64_t y);
  Square& entryOf(std::uint64_t key) { return squares_[key % squares_.size()]; }
  double timesSeen(std::uint64_t key, StampUs stamp_us);

  const RobustParams& params_;
  std::vector<Square> squares_;
};

}  // namespace vismem
