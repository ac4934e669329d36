/// @file Joint readings over time. Pure.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/geometry/angles.h"
#include "common/robot/samples.h"

namespace vismem {

/// Smaller backlash is below what readings resolve.
inline constexpr double kLeastBacklash_rad = degToRad(0.2);

/// How far a motor leads its head, in halves of the joint's backlash. The head is behind by as much.
struct MotorLead {
  /// 1 after a motion to the left or up, -1 after one to the right or down, 0 before the first motion.
  double side = 0.0;
  std::optional<double> turned;  ///< reading at a reversal that the head has not followed yet [rad]

  /// `side`, or between 1 and -1 while the motor has turned back within the backlash: the head rests, or
  /// follows in part where readings do not resolve the backlash.
  /// @param T double or ceres::Jet. @param backlash_value the scalar part of `backlash`.
  template <typename T>
  T lead(const T& scale, const T& backlash, double backlash_value, const T& reading) const {
    if (!turned) return T(side);
    const T width = backlash_value < kLeastBacklash_rad ? T(kLeastBacklash_rad) : backlash;
    return side + 2.0 * scale * (reading - *turned) / width;
  }
  /// The head's angle [rad]; parameters of lead().
  template <typename T>
  T headAngle(const T& scale, const T& backlash, double backlash_value, const T& reading) const {
    return scale * reading - 0.5 * backlash * lead(scale, backlash, backlash_value, reading);
  }
};

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
  /// Of pan and tilt at a stamp.
  /// @param backlash_rad in reported angles; smaller ones count as kLeastBacklash_rad: readings are not
  /// exact.
  std::array<MotorLead, 2> leadAt(double time_s, const Eigen::Vector2d& backlash_rad) const;

 private:
  std::size_t stepAt(double time_s) const;

  std::vector<double> stamps_s_;
  std::vector<Eigen::Vector2d> angles_;
};

}  // namespace vismem
