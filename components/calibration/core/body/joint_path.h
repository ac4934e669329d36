/// @file Joint readings over time. Pure.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

/// Reported angles as a function of the joints' own stamps, linear between samples. *Immutable.*
class JointPath {
 public:
  /// @throws std::invalid_argument for fewer than two samples or stamps that do not rise.
  explicit JointPath(const std::vector<PanTiltSample>& samples);

  double beginS() const { return stamps_s_.front(); }
  double endS() const { return stamps_s_.back(); }

  /// Pan and tilt at a stamp [rad]; before and after the record the first and last step go on.
  /// @param T double or ceres::Jet. @param value_s the scalar part of `time_s`.
  template <typename T>
  Eigen::Matrix<T, 2, 1> at(const T& time_s, double value_s) const {
    const std::size_t i = stepAt(value_s);
    const T share = (time_s - T(stamps_s_[i])) / (stamps_s_[i + 1] - stamps_s_[i]);
    const Eigen::Vector2d step = angles_[i + 1] - angles_[i];
    return {T(angles_[i].x()) + share * step.x(), T(angles_[i].y()) + share * step.y()};
  }
  Eigen::Vector2d at(double time_s) const { return at<double>(time_s, time_s); }
  /// Largest minus smallest angle of the samples around a span of time, of the joint that moved more [rad].
  double spread(double from_s, double to_s) const;
  /// Direction of each joint's last motion before a stamp: 1 (left, up), -1, or 0 if there was none.
  Eigen::Vector2d directionAt(double time_s) const;

 private:
  std::size_t stepAt(double time_s) const;

  std::vector<double> stamps_s_;
  std::vector<Eigen::Vector2d> angles_;
  std::vector<Eigen::Vector2d> directions_;  ///< of the last motion up to each sample
};

}  // namespace vismem
