#include "active_visual_memory/core/ground/camera_knock.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {

CameraKnock knockOf(const CameraTilt& camera_tilt, const CameraTiltCovariance& P) {
  // Elevation: a mount turned about its y axis looks down, a camera turned about its x axis looks up. Roll:
  // both turn the right side down.
  Eigen::Matrix<double, 2, 4> sum;
  sum << 0.0, -1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0;
  const Eigen::Vector2d error = sum * camera_tilt;
  const Eigen::Matrix2d C = sum * P * sum.transpose();
  constexpr double kNone_rad = 1e-9;
  const double angle = error.norm();
  if (angle < kNone_rad) {
    return {angle, std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(C).eigenvalues()[1])};
  }
  return {angle, std::sqrt(error.dot(C * error)) / angle};
}

std::string KnockAlarm::update(const CameraKnock& knock) {
  constexpr double kBegin = 3.0;
  constexpr double kEnd = 2.0;
  if (calibrated_rad_ <= 0.0) return {};
  const double sigmas = knock.angle_rad / std::hypot(knock.sigma_rad, calibrated_rad_);
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  if (!on_ && sigmas > kBegin) {
    on_ = true;
    text << "the camera was knocked by " << radToDeg(knock.angle_rad) << " degrees (" << sigmas
         << " standard deviations): run calibrate body";
  } else if (on_ && sigmas < kEnd) {
    on_ = false;
    text << "the camera looks as it was calibrated again";
  }
  return text.str();
}

}  // namespace vismem
