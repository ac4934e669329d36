/// @file The least squares of `calibrate body`: its variables, residuals and solution. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/core/body/body_parameters.h"
#include "calibration/core/body/body_record.h"
#include "calibration/core/body/joint_path.h"
#include "calibration/core/body/observability.h"
#include "calibration/core/odometry/wheel_path.h"

namespace vismem {

/// What the user measured or knows: one parameter with its standard deviation [SI].
struct BodyKnowledge {
  std::size_t parameter = 0;  ///< index as of parameterOf()
  double value = 0.0;
  double sigma = 0.0;
};

/// Start values; the residuals refine them.
struct BodyNoise {
  double corners = 1.0;                ///< standard deviations over those that the corners' finder states
  double repeatability_rad = 0.00087;  ///< of a joint: 0.05 degrees
  double wheel_sqrtm = 0.002;          ///< of each wheel after one metre [m]
};

/// Which residuals and variables a solution has.
struct BodyStage {
  bool moving_views = true;  ///< false: only views of a standing robot with a still head
  bool delays = true;        ///< false: time offsets stay as they are
};

/// Poses of the robot at its views; views from one standing place share a pose.
struct BodyPoses {
  std::vector<Eigen::Vector3d> poses;      ///< x, y, heading in world
  std::vector<std::size_t> pose_of_view;   ///< by view
  std::vector<Eigen::Vector2d> deviation;  ///< by view: of pan and tilt [rad]
};

struct BodyFit {
  double rms_px = 0.0;          ///< of used corners, each way
  double normalised_rms = 0.0;  ///< of used corners, in standard deviations of their finder
  std::size_t corners = 0;      ///< used
  bool converged = false;
  std::string message;
};

/// Standard deviations that residuals show over those that were assumed; empty where the data say too little.
struct NoiseRatio {
  std::optional<double> corners;
  std::optional<double> wheels;
  std::optional<double> joints;
};

/// One problem over a record. *Single-threaded.* Holds the values that it changes.
class BodyProblem {
 public:
  /// `weights` by view and corner, 0: an outlier. `knowledge` counts as information.
  struct Inputs {
    const BodyRecord* record = nullptr;
    const JointPath* joints = nullptr;
    const WheelPath* wheels = nullptr;
    const std::vector<bool>* still = nullptr;  ///< by view
    const std::vector<std::vector<double>>* weights = nullptr;
    std::vector<BodyKnowledge> knowledge;
    double aspect_sigma = 0.0;       ///< of the ratio of both focal lengths; 0: nothing is known of it
    std::vector<std::size_t> fixed;  ///< parameters that keep their values
    BodyNoise noise;
    BodyParameters start;  ///< centre of the weak priors
  };

  BodyProblem(Inputs inputs, BodyStage stage, BodyParameters& parameters, BodyPoses& poses);
  ~BodyProblem();
  BodyProblem(const BodyProblem&) = delete;
  BodyProblem& operator=(const BodyProblem&) = delete;

  BodyFit solve();
  /// Information of the data and of `knowledge` about the free parameters, everything else eliminated.
  ParameterInformation information();
  /// Estimates of variance components (Foerstner 1979): a group's squared residuals over its redundancy,
  /// which is small where poses between images are free to follow the images.
  NoiseRatio noiseRatio();
  /// Corner residuals in standard deviations of the corners' finder, by view and corner; 0 for unused
  /// corners.
  std::vector<std::vector<double>> cornerErrors() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
