/// @file How far odometry has drifted since the memory was made, from what an image shows of it. Pure. SPEC
/// M6.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/pose.h"

namespace vismem {

/// A rigid motion of the plane that is small: p moves by shift + turn x (p - pivot).
struct SmallMotion {
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]
  double turn_rad = 0.0;

  Eigen::Vector2d apply(const Eigen::Vector2d& p) const;
};

/// One coordinate in which an observation differs from the memory.
struct DriftResidual {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();           ///< where it was observed, in odom [m]
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< along which both are compared
  double residual_m = 0.0;                               ///< observed minus remembered
  double variance_m2 = 1.0;                              ///< of the difference, without drift
};

/// The drift of odometry relative to the memory as a small random motion about the robot: it grows while the
/// robot moves and shrinks with what is seen. A robot that stands cannot drift. *Single-threaded value.* The
/// memory follows the drift as one rigid whole, so that what was seen long ago stays right relative to the
/// robot, and what comes into view again is met where it is expected.
class DriftAlignment {
 public:
  struct Params {
    double shift_per_m = 0.02;     ///< sigma of the drift per metre driven
    double turn_per_rad = 0.02;    ///< per radian turned
    double turn_per_m = 0.02;      ///< [rad/m]
    double shift_per_rad = 0.005;  ///< [m/rad]
    double huber = 1.5;            ///< residuals beyond so many sigmas count less
    double gate = 4.0;             ///< and beyond so many, nothing
    int iterations = 3;
  };

  /// The robot moved. @param moved T_before_now.
  void travel(const Pose2& moved, const Params& params);

  /// @return how the memory has to move about the robot to agree with the image; empty when nothing tells.
  std::optional<SmallMotion> solve(const Eigen::Vector2d& robot, std::span<const DriftResidual> residuals,
                                   const Params& params);

  /// Sigma of the drift across the view at a distance from the robot [m].
  double sigmaAt(double distance_m) const;
  void reset() { P_.setZero(); }

 private:
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();  ///< of (shift x, shift y, turn) about the robot
};

}  // namespace vismem
