/// @file How far odometry has drifted since the memory was made, and how the camera leans, from what an image
/// shows of both. Pure. SPEC M1, M6.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "active_visual_memory/core/camera_lean.h"
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
  double variance_m2 = 1.0;                              ///< of the difference, without drift and lean
  LeanRow d_lean =
      LeanRow::Zero();  ///< how the lean moves the observed minus the remembered coordinate [m/rad]
  Eigen::RowVector2d d_sway =
      Eigen::RowVector2d::Zero();  ///< how a sway of this image moves the observed one
  double d_course = 0.0;  ///< how it follows the course of this image's straight lines (addCourseResiduals)
  double d_turn = 0.0;    ///< and, beside what `direction` says, the turn of the memory
};

/// What one image tells.
struct Correction {
  SmallMotion motion;        ///< of the memory
  Lean lean = Lean::Zero();  ///< change of what is believed of the lean
  Eigen::Vector2d sway =
      Eigen::Vector2d::Zero();  ///< about the robot's x and y axes, in this image beside the lean
  Eigen::Matrix2d P_sway = Eigen::Matrix2d::Zero();  ///< how well the sway is known [rad^2]
};

/// The drift of odometry relative to the memory as a small random motion about the robot: it grows while the
/// robot moves and shrinks with what is seen. A robot that stands cannot drift. What of the drift of the
/// heading goes on in the same direction (wheels or legs that are not alike, a wrong base) is estimated and
/// expected: else a robot that turns would always be behind. Beside it the lean of the camera, which stays,
/// and its sway, which is another in each image; all errors are known with their covariance. *Single-threaded
/// value.* The memory follows the drift as one rigid whole, so that what was seen long ago stays right
/// relative to the robot, and what comes into view again is met where it is expected.
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

  DriftAlignment() = default;
  explicit DriftAlignment(const LeanParams& lean) : lean_params_(lean) {
    P_.block<4, 4>(kLean, kLean) = lean.prior();
  }

  /// The robot moved. @param before, now T_odom_robot.
  /// @return how the memory moves with it, as far as that was learnt.
  SmallMotion travel(const Pose2& before, const Pose2& now, const Params& params);

  /// @return how memory and lean have to change to agree with the image; empty when nothing tells.
  std::optional<Correction> solve(const Eigen::Vector2d& robot, std::span<const DriftResidual> residuals,
                                  const Params& params);

  const Lean& lean() const { return lean_; }
  LeanCovariance leanCovariance() const { return P_.block<4, 4>(kLean, kLean); }

  /// Drift of the heading per radian turned and per metre driven that goes on [rad/rad, rad/m].
  const Eigen::Vector2d& headingRates() const { return rates_; }

  /// Sigma of the drift across the view at a distance from the robot [m].
  double sigmaAt(double distance_m) const;
  /// The memory begins anew. What is known of the lean and of the odometry stays.
  void reset();

 private:
  static constexpr int kTurn = 2;
  static constexpr int kLean = 3;
  static constexpr int kRates = 7;
  static constexpr int kLasting = 9;  ///< what lasts from image to image; behind it the sway

  LeanParams lean_params_{0.0, 0.0, 0.0};
  Lean lean_ = Lean::Zero();
  Eigen::Vector2d rates_ = Eigen::Vector2d::Zero();
  bool moved_ = false;  ///< ever: the rates have their prior
  /// Of (shift x, shift y, turn) about the robot, the lean and the rates.
  Eigen::Matrix<double, kLasting, kLasting> P_ = Eigen::Matrix<double, kLasting, kLasting>::Zero();
};

}  // namespace vismem
