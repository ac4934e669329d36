#include "common/geometry/angles.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

// Up to here one turn more or less is enough, and the subtraction is exact. std::remainder would dominate the
// time of comparing thousands of points.
constexpr double kNearTurns_rad = 9.0;

}  // namespace

double wrapAngle(double angle_rad) {
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  if (std::abs(angle_rad) < kNearTurns_rad) {
    return angle_rad - std::copysign(2.0 * std::numbers::pi, angle_rad);
  }
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

double angleDifference(double to_rad, double from_rad) {
  return wrapAngle(to_rad - from_rad);
}

double lineAngleDifference(double a_rad, double b_rad) {
  const double turn = std::abs(angleDifference(a_rad, b_rad));
  return std::min(turn, std::numbers::pi - turn);
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
