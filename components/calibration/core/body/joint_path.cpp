#include "calibration/core/body/joint_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace vismem {

JointPath::JointPath(const std::vector<PanTiltSample>& samples) {
  if (samples.size() < 2) throw std::invalid_argument("fewer than two samples of the joints");
  for (const PanTiltSample& sample : samples) {
    const double stamp_s = toSeconds(sample.stamp_us);
    if (!stamps_s_.empty() && stamp_s <= stamps_s_.back()) {
      throw std::invalid_argument("the joints' stamps do not rise");
    }
    stamps_s_.push_back(stamp_s);
    angles_.emplace_back(sample.pan_rad, sample.tilt_rad);
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

std::array<MotorLead, 2> JointPath::leadAt(double time_s, const Eigen::Vector2d& backlash_rad) const {
  const Eigen::Vector2d now = at(time_s);
  std::array<MotorLead, 2> leads;
  for (int j = 0; j < 2; ++j) {
    // The last motion across the backlash ended in an extreme, where the head was half of it behind. It has
    // not moved since: the motor stayed within the backlash of that extreme.
    const double width = std::max(backlash_rad[j], kLeastBacklash_rad);
    double low = now[j];
    double high = now[j];
    for (std::size_t i = stepAt(time_s) + 1; i-- > 0;) {
      low = std::min(low, angles_[i][j]);
      high = std::max(high, angles_[i][j]);
      if (high - low < width) continue;
      const bool came_down = angles_[i][j] == high;
      const double extreme = came_down ? low : high;
      MotorLead& lead = leads[static_cast<std::size_t>(j)];
      lead.side = came_down ? -1.0 : 1.0;
      if (now[j] != extreme) lead.turned = extreme;
      break;
    }
  }
  return leads;
}

}  // namespace vismem
