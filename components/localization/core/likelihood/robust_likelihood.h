/// @file Likelihood of a pose with bounded influence of every point, its maximization, and its curvature.
/// Pure. Implements L12. See B2. Likelihood field: Thrun, Burgard and Fox, "Probabilistic Robotics", 6.4;
/// bounded loss: a mixture of a Gaussian and a uniform outlier density, iteratively reweighted.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "localization/core/likelihood/individual.h"
#include "localization/core/likelihood/placement.h"
#include "localization/core/likelihood/tilt_mixture.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

struct LikelihoodParams {
  double outlier_share = 0.10;  ///< eps of the bounded likelihood
  bool bounded = true;          ///< false: squared distances with unbounded influence
  bool direction_gate = true;   ///< compare points with map segments of similar direction only
  double direction_gate_rad = degToRad(20.0);
  /// Prior standard deviations of the camera tilt error per axis: its lasting part (calibration) and its part
  /// in a single image (bumps, a walking body). Both are estimated with the pose; 0: fixed at 0. The lasting
  /// part is small: a larger one takes up errors of lens and map.
  double tilt_bias_rad = degToRad(0.1);
  double frame_tilt_rad = degToRad(0.2);
  /// Standard deviations of the memory's position and heading as a rigid whole, relative to the current pose
  /// (odometry error since). 0: rigid.
  double memory_shift_m = 0.03;
  double memory_turn_rad = degToRad(2.0);
  /// Smallest standard deviation for Rating::explained: map and calibration may err by centimetres at the
  /// true pose.
  double explained_sigma_m = 0.025;

  void visit(ParameterVisitor& v);
};

/// How the map must be indexed for this likelihood.
MapIndex::Params robustIndex(const LikelihoodParams& params, const MapParams& map);

struct Rating {
  /// Sum of weight * log((1 - eps) exp(-d^2 / 2 sigma^2) + eps), <= 0 [nats]. Unbounded: sum of weight *
  /// -d^2 / 2 sigma^2, with d truncated at the reach of the fields.
  double log_likelihood = 0.0;
  /// Weighted share of points that agree with the map, 0..1: each by exp(-d^2 / 2 sigma^2), with a sigma of
  /// at least `explained_sigma_m`.
  double explained = 0.0;
  /// Variance factor of unit weight: weighted mean of (d / sigma)^2 over the inliers. 1: points deviate from
  /// the map as their sigmas predict.
  double variance_factor = 0.0;
};

/// Derivative of a floor point by the errors of the camera, in the order of CameraErrors.
using CameraJacobian = Eigen::Matrix<double, 2, kCameraErrors>;

/// Derivative of a pose (x, y, theta) by the errors of the camera.
using PoseJacobian = Eigen::Matrix<double, 3, kCameraErrors>;

/// Quadratic form of -log L of one image in the errors of the camera, with pose and tilt of this image
/// marginalized.
struct CameraEvidence {
  CameraMatrix information = CameraMatrix::Zero();
  CameraVector gradient = CameraVector::Zero();      ///< at the errors that the observation was made with
  Eigen::Vector3d step = Eigen::Vector3d::Zero();    ///< to the pose (x, y, theta) that fits best
  PoseJacobian d_pose = PoseJacobian::Zero();        ///< of the pose that fits best, by the errors
  Eigen::Matrix3d P_pose = Eigen::Matrix3d::Zero();  ///< of that pose, for known errors
};

/// Rates poses by one observation. *Pure*; keeps references to its arguments.
class RobustLikelihood {
 public:
  RobustLikelihood(const MapIndex& map, const LikelihoodParams& params)
      : map_(map), params_(params), log_outlier_share_(std::log(params.outlier_share)) {}

  /// @param blur_m added to every sigma as root sum of squares: a coarse search must not miss narrow peaks.
  Rating rate(const FloorObservation& observation, const Placement& placement, double blur_m = 0.0) const;

  /// Sets the health of many poses to Rating::explained. Poses whose every fourth point yields less than half
  /// of `least` get 0 without further rating.
  /// @param observation of at most kMaximumPoints points.
  void explain(const FloorObservation& observation, std::span<Individual> places, double blur_m,
               double least) const;

  struct Refined {
    Placement placement;
    /// Curvature of -log L (without the prior) at the result in (x, y, theta, tilt bias), with this image's
    /// frame tilt marginalized.
    Matrix5d information = Matrix5d::Zero();
    Matrix5d image_information = Matrix5d::Zero();  ///< the same of the image's points alone
    Rating rating;                                  ///< at the result
  };

  /// Gauss-Newton steps on -share * log L plus the prior's squared Mahalanobis distance; the measurement
  /// update of an iterated extended Kalman filter (Bell and Cathey 1993). The bounded loss has no gradient
  /// beyond a few sigmas, and a tilt of one degree moves points by many. Without a blur, three steps come
  /// first with the innovation variance of each point, whose predicted part falls by a factor of 10 from one
  /// to the next (graduated non-convexity: Blake and Zisserman, "Visual Reconstruction", 1987).
  /// @param prior_information about the start; zero for none.
  /// @param share scales the observation.
  /// @param steps 0: only the rating and the curvature at the start.
  /// @param blur_m added to every sigma, for a coarse search.
  /// @param tilt further prior of the tilt bias, about 0.
  Refined refine(const FloorObservation& observation, const Placement& start,
                 const Matrix5d& prior_information, double share, int steps, double blur_m,
                 const TiltMixture& tilt = {}) const;

  /// What the image's points say about the camera's errors.
  /// @param derivatives of the observation's points from `remembered` on.
  CameraEvidence cameraEvidence(const FloorObservation& observation, const Placement& placement,
                                std::span<const CameraJacobian> derivatives, double blur_m) const;

 private:
  struct Blur;
  struct Curvature;
  struct Match;
  /// @param R  rotation by the placement's heading.
  std::optional<Match> match(const FloorPoint& point, const Placement& placement, const Eigen::Matrix2d& R,
                             const Blur& blur) const;
  Curvature curvature(std::span<const FloorPoint> points, const Placement& placement, double share,
                      const Blur& blur, Rating* rating) const;
  void marginalizeMemoryShift(Curvature& memory) const;
  double explainedVariance(const FloorPoint& point, double blur_m) const;
  /// Adds one point to a rating.
  /// @param distance_m to the map; from the truncation distance on the point is an outlier.
  void add(Rating& rating, const FloorPoint& point, double distance_m, double blur_m) const;

  const MapIndex& map_;
  const LikelihoodParams& params_;
  double log_outlier_share_;
};

}  // namespace vismem
