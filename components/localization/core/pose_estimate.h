/// @file What localization tells the world. Pure. SPEC L1, L7, L8; DESIGN 9, 14.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "common/robot/ports.h"

namespace vismem {

/// One place where the robot may be.
struct RaceReport {
  std::uint64_t id = 0;  ///< never used twice
  Pose2 T_world_robot;   ///< at the estimate's stamp
  double health = 0.0;   ///< 0..1
  double weight = 0.0;   ///< share of belief, sums to 1 over the races
  int victories = 0;
  int age = 0;  ///< iterations
  bool winner = false;
};

/// What odometry was found to do wrong all the time.
struct OdometryBelief {
  /// It turned too little per metre forward [rad/m], turned too little per radian, went too short per metre.
  Eigen::Vector3d errors = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
};

struct PoseEstimate {
  StampUs stamp_us = 0;        ///< of the image used
  std::uint64_t revision = 0;  ///< counts up by one per update that was used
  /// The winner's pose; empty while there is no race at all.
  std::optional<Pose2> T_world_robot;
  Pose2 T_odom_robot;  ///< at stamp_us: carries the pose forward as odometry moves on
  /// Of (x, y, theta) [m^2, m rad, rad^2].
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  double reliability = 0.0;  ///< 0 lost .. 1 sure
  std::vector<RaceReport> races;
  std::optional<OdometryBelief> odometry;  ///< empty: nothing is learnt of it
};

/// Belief about the world frame that callers may force on the component.
class LocalizationControl {
 public:
  virtual ~LocalizationControl() = default;
  /// The newest estimate; empty before the first.
  virtual std::optional<PoseEstimate> latest() const = 0;
  /// The newest estimate with a revision above `after_revision`; waits at most `timeout`; empty if none came.
  virtual std::optional<PoseEstimate> next(std::uint64_t after_revision,
                                           std::chrono::milliseconds timeout) = 0;
  /// "The robot is here": one race there, as reliable as what was seen last lets it be.
  virtual PortReply setPose(const Pose2& T_world_robot) = 0;
  /// "Forget where you were": no race, explore everywhere.
  virtual PortReply relocalize() = 0;
};

}  // namespace vismem
