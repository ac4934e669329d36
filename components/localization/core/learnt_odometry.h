/// @file What odometry does wrong all the time, learnt from where the robot turned out to be. Pure. DESIGN 9
/// part 3.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/geometry/pose.h"
#include "localization/core/params.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Wheels or legs that are not alike turn a robot that goes straight, a wrong base makes turns too wide, a
/// wrong radius ways too long: errors that stay. A filter that expects noise only is always behind them, and
/// without anything to see they are most of what goes wrong. A Kalman filter over pieces of the way compares
/// odometry with the poses of a trusted place at their ends. *Single-threaded* (owner: the localizer).
class LearntOdometry {
 public:
  explicit LearntOdometry(const LearntOdometryParams& params);

  /// A motion by odometry, without what is known to be wrong of it.
  Pose2 corrected(const Pose2& T_before_now) const;

  /// The robot moved so by odometry. Every motion, in order, as odometry tells it.
  void travel(const Pose2& T_before_now);
  /// It stands there now, on trust. @param id of the race that says so: another one begins another piece.
  void standsAt(const Pose2& T_world_robot, std::uint64_t id);
  /// Nobody is to be trusted now: the piece that was begun tells nothing. What was learnt stays.
  void lost() { start_.reset(); }

  const OdometryBelief& belief() const { return belief_; }

 private:
  struct Start {
    std::uint64_t id = 0;
    Pose2 T_world_robot;
  };

  void begin(const Pose2& T_world_robot, std::uint64_t id);
  /// One measurement z = H * errors + noise, unless it is too far from what is believed.
  void take(double z, const Eigen::RowVector3d& H, double variance);

  LearntOdometryParams params_;
  OdometryBelief belief_;
  std::optional<Start> start_;
  // Of the piece, by odometry alone:
  Pose2 moved_;             ///< from its start
  double turned_ = 0.0;     ///< with its sign, full turns too [rad]
  double forward_ = 0.0;    ///< with its sign [m]
  double travelled_ = 0.0;  ///< without [m]
  double swung_ = 0.0;      ///< turns without their sign [rad]
};

}  // namespace vismem
