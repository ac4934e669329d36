/// @file The estimate that localization publishes, and the commands that it takes. Pure. See L1, L7, L8.
#pragma once

#include <Eigen/Core>
#include <bitset>
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

/// Estimated lasting errors of odometry.
struct OdometryBias {
  /// Yaw bias per metre forward [rad/m], yaw scale error, distance scale error; positive where odometry
  /// reports too little.
  Eigen::Vector3d errors = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
};

inline constexpr int kCameraErrors = 7;
using CameraVector = Eigen::Matrix<double, kCameraErrors, 1>;
using CameraMatrix = Eigen::Matrix<double, kCameraErrors, kCameraErrors>;

/// Lasting errors of the camera, true minus configured value.
struct CameraErrors {
  /// Height [m]; focal length [share]; turns about the camera's x axis (positive looks up) and its optical
  /// axis, and about the robot's y axis (positive looks down) and x axis [rad]; age of images beyond their
  /// stamps [s].
  enum Error { kHeight, kFocal, kPitch, kRoll, kMountPitch, kMountRoll, kDelay };
  CameraVector errors = CameraVector::Zero();  ///< posterior means, which the pose is corrected for
  CameraVector sigmas = CameraVector::Zero();  ///< standard deviations; 0: nothing was learnt yet
  std::bitset<kCameraErrors> found;            ///< probably not 0

  bool isFound(int error) const { return found[static_cast<std::size_t>(error)]; }
};

struct PoseEstimate {
  StampUs stamp_us = 0;        ///< of the image used
  std::uint64_t revision = 0;  ///< counts up by one per update that was used
  /// The winner's pose; empty without a race.
  std::optional<Pose2> T_world_robot;
  Pose2 T_odom_robot;  ///< at stamp_us; a reader predicts the present pose with newer odometry
  /// Of (x, y, theta) [m^2, m rad, rad^2].
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  /// Default mode: estimated probability that the pose is right (0.25 m, 15 degrees). 0: lost. Chapter mode:
  /// by the health of the last seconds.
  double reliability = 0.0;
  double support = 0.0;  ///< of the winner by the last seconds, 0..1; search and gaze requests go by it
  std::vector<RaceReport> races;
  std::optional<OdometryBias> odometry;  ///< empty: not estimated
  std::optional<CameraErrors> camera;    ///< empty: not estimated
};

/// Commands that replace the estimate.
class PoseCommands {
 public:
  virtual ~PoseCommands() = default;
  /// Replaces all races by one at this pose, with the reliability that the last observation supports.
  virtual PortReply setPose(const Pose2& T_world_robot) = 0;
  /// Deletes all races and searches the whole map.
  virtual PortReply relocalize() = 0;
};

/// Access to the estimate, and the commands.
class LocalizationControl : public PoseCommands {
 public:
  /// The newest estimate; empty before the first.
  virtual std::optional<PoseEstimate> latest() const = 0;
  /// The newest estimate with a revision above `after_revision`; waits at most `timeout`; empty if none came.
  virtual std::optional<PoseEstimate> next(std::uint64_t after_revision,
                                           std::chrono::milliseconds timeout) = 0;
};

}  // namespace vismem
