#include "common/geometry/angles.h"

#include <cmath>

namespace vismem {

double wrapAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

double angleDifference(double to_rad, double from_rad) {
  return wrapAngle(to_rad - from_rad);
}

double lineAngleDifference(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, std::numbers::pi));
}

double circularMean(std::span<const double> angles_rad) {
  double sum_cos = 0.0;
  double sum_sin = 0.0;
  for (const double angle : angles_rad) {
    sum_cos += std::cos(angle);
    sum_sin += std::sin(angle);
  }
  constexpr double kCancelled = 1e-12;
  if (std::hypot(sum_cos, sum_sin) < kCancelled) return 0.0;
  return std::atan2(sum_sin, sum_cos);
}

}  // namespace vismem
