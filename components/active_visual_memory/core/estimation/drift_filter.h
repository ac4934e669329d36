/// @file Odometry drift since the memory was made, and camera tilt, from what an image shows of both. Pure.
/// See M1, M6.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "common/geometry/planar_increment.h"
#include "common/geometry/pose.h"

namespace vismem {

/// One coordinate in which an observation differs from the memory.
struct DriftResidual {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();           ///< observed point in odom [m]
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< along which both are compared
  double residual_m = 0.0;                               ///< observed minus remembered
  double variance_m2 = 1.0;                              ///< of the difference, without drift and tilt
  /// Derivative of observed minus remembered by the camera tilt [m/rad].
  TiltJacobianRow d_tilt = TiltJacobianRow::Zero();
  /// Derivative of the observed coordinate by the tilt of this frame [m/rad].
  Eigen::RowVector2d d_frame_tilt = Eigen::RowVector2d::Zero();
  double d_direction = 0.0;  ///< derivative by the direction of this image's lines (addDirectionResiduals)
  double d_turn = 0.0;       ///< derivative by the turn of the memory, beside that of `direction`
};

/// Result of one image.
struct Correction {
  PlanarIncrement motion;                                  ///< of the memory
  CameraTilt camera_tilt = CameraTilt::Zero();             ///< change of the tilt estimate [rad]
  Eigen::Vector2d frame_tilt = Eigen::Vector2d::Zero();    ///< of this image, about the robot's x and y [rad]
  Eigen::Matrix2d P_frame_tilt = Eigen::Matrix2d::Zero();  ///< posterior covariance [rad^2]
};

/// Filter of odometry drift and camera tilt. The drift relative to the memory is a random motion about the
/// robot that grows with the way; a robot that stands does not drift. Its state further holds lasting heading
/// rates (unequal wheels, a wrong wheel base), the camera tilt, and a per-frame tilt that is drawn anew for
/// each image. The update is iterated least squares with a Huber weight and a gate (Huber 1964). The memory
/// follows the drift as one rigid whole. *Single-threaded value.*
class DriftFilter {
 public:
  struct Params {
    double shift_per_m = 0.02;     ///< sigma of the drift per metre driven
    double turn_per_rad = 0.02;    ///< per radian turned
    double turn_per_m = 0.02;      ///< [rad/m]
    double shift_per_rad = 0.005;  ///< [m/rad]
    double huber = 1.5;            ///< sigmas beyond which a residual has less weight
    double gate = 4.0;             ///< sigmas beyond which it has none
    int iterations = 3;
  };

  DriftFilter() = default;
  explicit DriftFilter(const TiltPrior& tilt_prior) : tilt_prior_(tilt_prior) {
    P_.block<4, 4>(kTilt, kTilt) = tilt_prior.prior();
  }

  /// Prediction by odometry. @param before previous T_odom_robot. @param now present T_odom_robot.
  /// @return the expected motion of the memory by the heading rates.
  PlanarIncrement predict(const Pose2& before, const Pose2& now, const Params& params);

  /// Update by the residuals of one image.
  /// @return how memory and tilt change; empty without information.
  std::optional<Correction> update(const Eigen::Vector2d& robot, std::span<const DriftResidual> residuals,
                                   const Params& params);

  const CameraTilt& cameraTilt() const { return camera_tilt_; }
  CameraTiltCovariance cameraTiltCovariance() const { return P_.block<4, 4>(kTilt, kTilt); }

  /// Sigma of the drift across the view at a distance from the robot [m].
  double sigmaAt(double distance_m) const;
  /// Begins a new memory; the estimates of tilt and rates stay.
  void reset();

 private:
  static constexpr int kTurn = 2;
  static constexpr int kTilt = 3;
  static constexpr int kRates = 7;
  static constexpr int kLasting = 9;  ///< unknowns kept from image to image; the frame tilt follows

  TiltPrior tilt_prior_{0.0, 0.0, 0.0};
  CameraTilt camera_tilt_ = CameraTilt::Zero();
  Eigen::Vector2d rates_ = Eigen::Vector2d::Zero();
  bool moved_ = false;  ///< the rates have their prior
  /// Of (shift x, shift y, turn) about the robot, the camera tilt and the rates.
  Eigen::Matrix<double, kLasting, kLasting> P_ = Eigen::Matrix<double, kLasting, kLasting>::Zero();
};

}  // namespace vismem
