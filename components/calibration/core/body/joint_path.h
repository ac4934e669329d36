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
  /// 1 after a motion to the left or up, -1 after one to the right or down, in between after a reversal that
  /// has not crossed the backlash, 0 before the first motion that has.
  double lead = 0.0;
  double side = 0.0;             ///< the lead at the last reversal: 1, -1, or 0
  std::optional<double> turned;  ///< reading at a reversal that the head has not followed yet [rad]

  /// The head's angle [rad].
  /// @param T double or ceres::Jet. @param backlash_value the scalar part of `backlash`.
  template <typename T>
  T headAngle(const T& scale, const T& backlash, double backlash_value, const T& reading) const {
    const T angle = scale * reading - backlash * (0.5 * side);
    if (!turned) return angle;
    // Within the backlash the head rests; within less than readings resolve, it follows in part.
    const T resting = backlash_value < kLeastBacklash_rad ? backlash / kLeastBacklash_rad : T(1.0);
    return angle - resting * scale * (reading - *turned);
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
