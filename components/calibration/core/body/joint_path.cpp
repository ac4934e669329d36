#include "calibration/core/body/joint_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Motion against the play of a joint: smaller steps of a reading are noise.
constexpr double kMotion_rad = degToRad(0.3);

}  // namespace

JointPath::JointPath(const std::vector<PanTiltSample>& samples) {
  if (samples.size() < 2) throw std::invalid_argument("fewer than two samples of the joints");
  Eigen::Vector2d turning_point(samples.front().pan_rad, samples.front().tilt_rad);
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  for (const PanTiltSample& sample : samples) {
    const double stamp_s = toSeconds(sample.stamp_us);
    if (!stamps_s_.empty() && stamp_s <= stamps_s_.back()) {
      throw std::invalid_argument("the joints' stamps do not rise");
    }
    const Eigen::Vector2d angles(sample.pan_rad, sample.tilt_rad);
    for (int j = 0; j < 2; ++j) {
      const double way = angles[j] - turning_point[j];
      if (way * direction[j] > 0.0) {
        turning_point[j] = angles[j];
      } else if (std::abs(way) > kMotion_rad) {
        direction[j] = way > 0.0 ? 1.0 : -1.0;
        turning_point[j] = angles[j];
      }
    }
    stamps_s_.push_back(stamp_s);
    angles_.push_back(angles);
    directions_.push_back(direction);
  }
}

std::size_t JointPath::stepAt(double time_s) const {
  const auto after = std::upper_bound(stamps_s_.begin(), stamps_s_.end(), time_s);
  const auto index = static_cast<std::size_t>(after - stamps_s_.begin());
  return std::min(index == 0 ? 0 : index - 1, stamps_s_.size() - 2);
}

double JointPath::spread(double from_s, double to_s) const {
  const std::size_t first = stepAt(from_s);
  Eigen::Vector2d least = angles_[first];
  Eigen::Vector2d most = least;
  for (std::size_t i = first + 1; i <= stepAt(to_s) + 1; ++i) {
    least = least.cwiseMin(angles_[i]);
    most = most.cwiseMax(angles_[i]);
  }
  return (most - least).maxCoeff();
}

Eigen::Vector2d JointPath::directionAt(double time_s) const {
  return directions_[stepAt(time_s)];
}

}  // namespace vismem
