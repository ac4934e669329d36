/// @file Joint readings over time. Pure.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/angles.h"
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
  /// How far each motor leads its head at a stamp, in halves of the joint's backlash: 1 after a motion to the
  /// left or up, -1 after one to the right or down, in between after a reversal that has not crossed the
  /// backlash, 0 before the first motion that has.
  /// @param backlash_rad of pan and tilt; smaller ones count as kLeastBacklash_rad: readings are not exact.
  Eigen::Vector2d leadAt(double time_s, const Eigen::Vector2d& backlash_rad) const;
  static constexpr double kLeastBacklash_rad = degToRad(0.2);

 private:
  std::size_t stepAt(double time_s) const;

  std::vector<double> stamps_s_;
  std::vector<Eigen::Vector2d> angles_;
};

}  // namespace vismem
