/// @file Estimation of the lasting errors of odometry from trusted poses. Pure. See L2.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "common/geometry/pose.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Prior of the lasting errors of the heading, and noise of the measurements.
struct OdometryCalibrationParams {
  bool enabled = true;
  /// Prior standard deviations: yaw bias [rad/m], yaw scale error.
  double turn_per_m = 0.05;
  double turn_share = 0.03;
  double walk_share = 0.02;  ///< random walk per square root of a metre, relative to these

  void visit(ParameterVisitor& v) {
    v.alias("Learn", "Calibrate");
    v.flag(basic("Calibrate",
                 "estimate and remove lasting errors of odometry: yaw bias, yaw scale, distance scale"),
           enabled);
  }
};

/// Kalman filter of two lasting errors: yaw bias per metre (unequal wheels or legs) and yaw scale (wrong
/// wheel base). A measurement compares odometry between two reference poses of one race with the poses. The
/// distance scale is a state of each race (Race::travel_scale) and stays 0 here. *Single-threaded* (owner:
/// Localizer).
class OdometryCalibration {
 public:
  explicit OdometryCalibration(const OdometryCalibrationParams& params);

  /// A motion by odometry with the estimated errors removed.
  Pose2 corrected(const Pose2& T_before_now) const;

  /// Adds a motion as odometry reports it. To be called for every motion, in order.
  void addMotion(const Pose2& T_before_now);
  /// Adds a trusted pose at the end of the motions so far.
  /// @param id of the race with this pose; another race starts a new measurement.
  void addReferencePose(const Pose2& T_world_robot, std::uint64_t id);
  /// Drops the measurement in progress; the estimate stays.
  void interrupt() { start_.reset(); }

  const OdometryBias& bias() const { return bias_; }

 private:
  struct Start {
    std::uint64_t id = 0;
    Pose2 T_world_robot;
  };

  void begin(const Pose2& T_world_robot, std::uint64_t id);
  /// Measurement update z = H * (yaw errors) + noise, unless the innovation exceeds the gate.
  void update(double z, const Eigen::RowVector2d& H, double variance);

  OdometryCalibrationParams params_;
  OdometryBias bias_;
  std::optional<Start> start_;
  // Sums of the measurement in progress, by odometry:
  Pose2 moved_;             ///< motion from its start
  double turned_ = 0.0;     ///< signed, without wrapping [rad]
  double forward_ = 0.0;    ///< signed [m]
  double travelled_ = 0.0;  ///< absolute [m]
  double swung_ = 0.0;      ///< absolute turns [rad]
};

}  // namespace vismem
