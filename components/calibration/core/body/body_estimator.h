/// @file `calibrate body`: from a record of views to a calibrated robot, and what of it is not observable.
/// Pure. See B5.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/core/body/body_parameters.h"
#include "calibration/core/body/body_problem.h"
#include "calibration/core/body/body_record.h"

namespace vismem {

struct BodyEstimatorParams {
  CameraMount mount;           ///< as described: start of the solution, and value of what is not observable
  double wheel_base_m = 0.33;  ///< that the odometry assumes
  BodyNoise noise;
  /// Standard deviations of the lens calibration [px]; 0: the lens is exact.
  double focal_sigma_px = 1.0;
  double centre_sigma_px = 1.0;
  double distortion_sigma_px = 1.0;  ///< of each coefficient: the shift of the image's corner
  /// Of the ratio of both focal lengths, which a lens calibration knows better than each.
  double aspect_sigma = 2e-4;
  /// Flatness of the board on the floor (roll, pitch) [rad].
  double flatness_sigma_rad = 0.0035;
  /// Of the joints, around none. A backlash that the views do not show widens the zeros by this.
  double backlash_sigma_rad = 0.0087;
  std::vector<BodyKnowledge> knowledge;  ///< tape measures of the user
};

/// One row of the result, for people and files.
struct EstimatedParameter {
  std::size_t index = 0;        ///< as of parameterOf(), or entry of CameraPlace
  double value = 0.0;           ///< [SI]; meaningless if not observable
  std::optional<double> sigma;  ///< [SI]; empty: not observable
};

struct BodyEstimate {
  /// The camera on the robot at joint readings 0: x, y, height, roll, tilt, yaw. Observable also where unit
  /// and camera cannot be told apart.
  std::array<EstimatedParameter, 6> place;
  BodyParameters parameters;  ///< unobservable ones near their start
  std::vector<EstimatedParameter> rows;
  std::vector<UnknownDirection> unknown;
  std::vector<std::string> warnings;
  BodyFit fit;
  BodyNoise noise;           ///< as the residuals show it
  std::size_t views = 0;     ///< used
  std::size_t outliers = 0;  ///< corners left out

  bool isObservable(std::size_t index) const;
};

/// @param progress is called before each stage with its name.
/// @throws std::runtime_error with the reason for people when the record does not suffice.
BodyEstimate estimateBody(const BodyRecord& record, const BodyEstimatorParams& params,
                          const std::function<void(const std::string&)>& progress = {});

}  // namespace vismem
