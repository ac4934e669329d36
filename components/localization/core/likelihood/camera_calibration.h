/// @file Estimation of the lasting errors of the camera from trusted poses, against the map. Pure. See L12.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/pose.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/likelihood/odometry_noise.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Information filter of the lasting errors of the camera (CameraErrors), linearized at its own estimate. A
/// map fixes the scale of what is seen, which a moving camera alone does not: on the floor a camera that
/// looks too high is a robot that travels too far. Pose and tilt of each image are free (Schur complement),
/// but odometry ties successive poses: images that are late turn the robot with its head.
/// Most errors are 0 (spike-and-slab prior): the posterior is mixed over all subsets of errors by their
/// evidence (Bayesian model averaging: Hoeting et al. 1999). Views in one direction leave several causes,
/// whose mean fits what was seen. *Single-threaded* (owner: RobustRaces); keeps references to its arguments.
class CameraCalibration {
 public:
  CameraCalibration(const RobustLikelihood& likelihood, const MapIndex& map, const ObservationParams& params,
                    const OdometryNoise& odometry);

  /// Begins an image, also one that is not learnt from: its camera as configured, and the camera's motion
  /// since the last image, which a delay needs.
  void begin(const ImageAnalysis& analysis);
  /// The camera of this image, corrected by the mean errors; empty before anything was learnt.
  std::optional<CameraModel> corrected() const;
  /// Fits the image that was begun last, and learns from it at a trusted pose.
  /// @param placement pose at its stamp, and camera tilt relative to the corrected camera.
  /// @return tilt by which the corrected camera turned, as Placement's [rad].
  Eigen::Vector2d fit(const ImageAnalysis& analysis, const Placement& placement, bool is_trusted);

  const CameraErrors& errors() const { return errors_; }
  /// Standard deviation of the corrected camera's tilt; before anything was learnt that of a tilt error
  /// [rad].
  double tiltSigma() const;
  /// Covariance of a pose (x, y, theta) in world that these errors cause, as it was for the last image that
  /// was fitted; 0 before.
  Eigen::Matrix3d poseCovariance() const;

 private:
  /// The pose that fits an image best, linear in the errors.
  struct FittedPose {
    StampUs stamp_us = 0;
    Pose2 T_odom_robot;
    Pose2 T_world_robot;
    PoseJacobian d_errors;
    Eigen::Matrix3d P;    ///< of (x, y, theta) for known errors
    CameraVector errors;  ///< for which T_world_robot was fitted
    bool is_trusted = false;
  };

  CameraModel view(const CameraVector& errors) const;
  void differentiate(const CameraModel& here);
  void compareMotion(const FittedPose& before, const FittedPose& now);
  void estimate();

  const RobustLikelihood& likelihood_;
  const MapIndex& map_;
  const ObservationParams& params_;
  const OdometryNoise& odometry_;
  CameraModel configured_;
  Pose3 T_odom_robot_ = Pose3::Identity();
  Pose3 T_odom_camera_before_ = Pose3::Identity();
  StampUs stamp_us_ = 0;
  double since_before_s_ = 0.0;  ///< 0: no motion is known
  CameraMatrix information_ = CameraMatrix::Zero();
  CameraVector information_vector_ = CameraVector::Zero();  ///< information times errors
  CameraErrors errors_;
  CameraMatrix P_ = CameraMatrix::Zero();    ///< posterior covariance of the errors, at first the prior's
  std::optional<FittedPose> fitted_;         ///< of the last image that was fitted
  FloorObservation seen_, observation_;      ///< of the last image that was fitted; all points, and some
  std::vector<CameraJacobian> derivatives_;  ///< of its points
};

/// Says once which errors of the camera were found, and again when they are others. *Single-threaded.*
class CameraAlarm {
 public:
  /// @return what to say now, such as "against the map: camera height error -1.9 +- 0.3 cm: run calibrate
  /// body"; empty for nothing new.
  std::string update(const CameraErrors& camera);

 private:
  std::bitset<kCameraErrors> named_;
};

/// An error in the unit of users.
struct CameraErrorText {
  const char* name;
  double scale;  ///< from SI
  const char* unit;
};
/// In the order of CameraErrors::Error.
inline constexpr std::array<CameraErrorText, kCameraErrors> kCameraErrorTexts{
    {{"camera height error", 100.0, "cm"},
     {"focal length error", 100.0, "%"},
     {"camera pitch error", radToDeg(1.0), "deg"},
     {"camera roll error", radToDeg(1.0), "deg"},
     {"mount pitch error", radToDeg(1.0), "deg"},
     {"mount roll error", radToDeg(1.0), "deg"},
     {"image delay", 1000.0, "ms"}}};

}  // namespace vismem
