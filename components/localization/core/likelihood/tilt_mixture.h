/// @file Prior of the lasting tilt of a camera. Pure. See B2, L12.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace vismem {

/// Prior odds of an error of the camera against none: a calibrated camera rarely changes.
inline constexpr double kUncalibratedOdds = 0.05;

/// Prior of the lasting tilt error (Placement::tilt_bias): the larger of two Gaussians about 0, equal in both
/// axes (max-mixture: Olson and Agarwal 2013). Most cameras are as calibrated, one in twenty is tilted about
/// some axis. Flat without standard deviations.
class TiltMixture {
 public:
  TiltMixture() = default;
  /// @param calibrated_rad standard deviation for a calibrated camera, above 0.
  /// @param wide_rad for any other one, at least `calibrated_rad`.
  TiltMixture(double calibrated_rad, double wide_rad)
      : calibrated_(1.0 / (calibrated_rad * calibrated_rad)),
        wide_(1.0 / (wide_rad * wide_rad)),
        log_odds_(std::log(kUncalibratedOdds * calibrated_rad / wide_rad)) {}

  /// Log density relative to that of no tilt [nats].
  double logDensity(const Eigen::Vector2d& tilt) const {
    return std::max(calibratedLog(tilt), wideLog(tilt));
  }

  /// Information per axis of the likelier component [1/rad^2].
  double information(const Eigen::Vector2d& tilt) const {
    return calibratedLog(tilt) < wideLog(tilt) ? wide_ : calibrated_;
  }
  /// The same of the wide component, which a search starts with.
  double wideInformation() const { return wide_; }

 private:
  double calibratedLog(const Eigen::Vector2d& tilt) const { return -0.5 * calibrated_ * tilt.squaredNorm(); }
  double wideLog(const Eigen::Vector2d& tilt) const { return log_odds_ - 0.5 * wide_ * tilt.squaredNorm(); }

  double calibrated_ = 0.0;  ///< 1 / variance
  double wide_ = 0.0;
  double log_odds_ = 0.0;
};

}  // namespace vismem
