/// @file Wheel radii, base, and place of a sensor from pieces of driving: wheel angles against the sensor's
/// own motions. Pure. See B5. Model: Censi, Franchi, Marchionni, Oriolo 2013, "Simultaneous calibration of
/// odometry and sensor parameters for mobile robots". The solution is iterated and robust where theirs is
/// closed.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vismem {

/// One piece of driving at even speeds.
struct WheelSensorMotion {
  double duration_s = 0.0;
  double left_radps = 0.0;  ///< wheel speeds
  double right_radps = 0.0;
  Eigen::Vector3d sensor =
      Eigen::Vector3d::Zero();  ///< motion of the sensor in its own frame: x, y [m], turn
};

/// Order of WheelSensorFit::covariance.
struct WheelSensorParameters {
  double left_radius_m = 0.0;
  double right_radius_m = 0.0;
  double base_m = 0.0;
  double x_m = 0.0;  ///< of the sensor on the robot
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Eigen::Matrix<double, 6, 1> vector() const {
    return {left_radius_m, right_radius_m, base_m, x_m, y_m, yaw_rad};
  }
};

struct WheelSensorFit {
  WheelSensorParameters parameters;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double position_sigma_m = 0.0;  ///< of the sensor's motions, as the residuals show it
  double turn_sigma_rad = 0.0;
};

/// Motion of the sensor that wheels predict.
Eigen::Vector3d predictedSensorMotion(const WheelSensorParameters& parameters,
                                      const WheelSensorMotion& motion);

/// Fits all six by Cauchy least squares from eight starts of the sensor's yaw. Wheels of negative radius at a
/// negative base with the sensor turned by half a turn explain every drive equally well (the mirrored
/// solution): radii and base are positive here.
/// @param radius_m, base_m rough: within a factor of two.
/// @throws std::runtime_error with the reason for too few motions, or when nothing converges.
WheelSensorFit fitWheelsAndSensor(const std::vector<WheelSensorMotion>& motions, double radius_m,
                                  double base_m);

}  // namespace vismem
