/// @file Estimation of the lasting errors of the camera from trusted poses, against the map. Pure. See L12.
#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <string>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Kalman filter of five lasting errors (CameraErrors). A map fixes the scale of what is seen, which a moving
/// camera alone does not: on the floor a camera that looks too high is a robot that travels too far. Pose and
/// tilt of each image are free (Schur complement). *Single-threaded* (owner: RobustRaces).
class CameraCalibration {
 public:
  CameraCalibration();

  /// Begins an image: its stated view, and the camera's motion since the last image, which a delay needs.
  void begin(const ImageAnalysis& analysis);
  /// The view of this image with the estimated errors removed.
  CameraModel corrected() const { return view(applied_); }
  /// Derivative by the errors of a point that this image showed on the floor [m per unit of CameraErrors].
  /// @param p_robot by the corrected view [m].
  CameraJacobian derivative(const Eigen::Vector2d& p_robot) const;
  /// Adds the evidence of this image, linearized at the corrected view.
  void add(const CameraEvidence& evidence);

  const CameraErrors& errors() const { return errors_; }

 private:
  CameraModel view(const CameraVector& errors) const;

  CameraModel stated_;
  Pose3 T_odom_robot_ = Pose3::Identity();
  Pose3 T_odom_camera_before_ = Pose3::Identity();
  StampUs stamp_us_ = 0;
  double since_before_s_ = 0.0;  ///< 0: no motion is known
  CameraMatrix information_ = CameraMatrix::Zero();
  CameraVector information_vector_ = CameraVector::Zero();  ///< information times errors
  CameraErrors errors_;
  CameraVector applied_ = CameraVector::Zero();  ///< the errors, nearer to 0 the less certain they are
};

/// Says once which errors of the camera are certain, and again when others are. *Single-threaded.*
class CameraAlarm {
 public:
  /// @return what to say now, such as "against the map: camera height error -1.9 +- 0.4 cm: run calibrate
  /// body"; empty for nothing new. An error is named from 3 standard deviations to below 2.
  std::string update(const CameraErrors& camera);

 private:
  std::bitset<5> named_;
};

/// An error in the unit of users.
struct CameraErrorText {
  const char* name;
  double scale;  ///< from SI
  const char* unit;
};
/// In the order of CameraErrors::Error.
inline constexpr std::array<CameraErrorText, 5> kCameraErrorTexts{
    {{"camera height error", 100.0, "cm"},
     {"focal length error", 100.0, "%"},
     {"camera pitch error", radToDeg(1.0), "deg"},
     {"camera roll error", radToDeg(1.0), "deg"},
     {"image delay", 1000.0, "ms"}}};

}  // namespace vismem
