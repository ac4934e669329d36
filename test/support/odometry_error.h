/// @file What errors of wheels do to a straight path, by formula.
#pragma once

#include <cmath>
#include <numbers>

#include "common/kinematics/odometry.h"

namespace vismem {

/// RMS position error of the wheel model after a straight path of length L, to first order in the errors.
/// With s = sqrt(2) radius_sigma / base and n = sqrt(2) travel_sigma / base, the variance is (s L^2 / 2)^2 +
/// n^2 L^3 / 3 across and (radius_sigma L)^2 / 2 + travel_sigma^2 L / 2 along. Slips and ticks are ignored.
inline double expectedStraightError_m(const OdometryErrorParams& errors, double wheel_base_m,
                                      double length_m) {
  const double L = length_m;
  const double systematic = std::numbers::sqrt2 * errors.radius_sigma / wheel_base_m;
  const double random = std::numbers::sqrt2 * errors.travel_sigma_sqrtm / wheel_base_m;
  const double across = std::pow(0.5 * systematic * L * L, 2) + random * random * L * L * L / 3.0;
  const double along =
      0.5 * std::pow(errors.radius_sigma * L, 2) + 0.5 * std::pow(errors.travel_sigma_sqrtm, 2) * L;
  return std::sqrt(across + along);
}

}  // namespace vismem
