#include "active_visual_memory/core/estimation/dominant_direction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {

double offDominantDirection(double direction_rad, double dominant_direction_rad) {
  return 0.25 * wrapAngle(4.0 * (direction_rad - dominant_direction_rad));
}

void DominantDirection::add(double direction_rad, double length_m) {
  if (length_m < params_.least_m) return;
  const double direction = offDominantDirection(direction_rad, 0.0) / (0.5 * std::numbers::pi) + 0.5;  // 0..1
  const int bin = std::clamp(static_cast<int>(direction * kBins), 0, kBins - 1);
  length_m_[bin] += length_m;
  sums_[bin] += length_m * Eigen::Vector2d(std::cos(4.0 * direction_rad), std::sin(4.0 * direction_rad));
  ++lines_[bin];
  all_m_ += length_m;
}

std::optional<double> DominantDirection::direction() const {
  const int reach = static_cast<int>(params_.together_rad / (0.5 * std::numbers::pi / kBins) + 0.5);
  double most_m = 0.0;
  std::optional<double> direction;
  for (int middle = 0; middle < kBins; ++middle) {
    double length_m = 0.0;
    int lines = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int i = middle - reach; i <= middle + reach; ++i) {
      length_m += length_m_[(i + kBins) % kBins];
      lines += lines_[(i + kBins) % kBins];
      sum += sums_[(i + kBins) % kBins];
    }
    if (lines < params_.least_lines || length_m < params_.least_share * all_m_ || length_m <= most_m)
      continue;
    most_m = length_m;
    direction = 0.25 * std::atan2(sum.y(), sum.x());
  }
  return direction;
}

}  // namespace vismem
