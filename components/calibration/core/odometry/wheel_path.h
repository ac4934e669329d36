/// @file Travel of both wheels from an odometry's poses, and the motion that it stands for under other
/// wheels. Pure.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/kinematics/wheel_correction.h"
#include "common/robot/samples.h"

namespace vismem {

/// Pose (x, y, heading) after a piece of a path on which both wheels turn evenly: an exact arc.
template <typename T>
Eigen::Matrix<T, 3, 1> advanced(const Eigen::Matrix<T, 3, 1>& pose, const T& travel, const T& turn) {
  using std::cos;
  using std::sin;
  // Chord of the arc: sin(h)/h to fourth order, exact to 1e-9 for turns of up to 0.1 rad.
  const T half = turn * 0.5;
  const T h2 = half * half;
  const T chord = travel * (1.0 - h2 / 6.0 + h2 * h2 / 120.0);
  const T direction = pose[2] + half;
  return {pose[0] + chord * cos(direction), pose[1] + chord * sin(direction), pose[2] + turn};
}

/// Wheel travel over time, reconstructed from the poses that an odometry reports. Between samples the wheels
/// turn evenly. *Immutable.*
class WheelPath {
 public:
  /// @param base_m that the odometry itself assumes. Any other value gives the same motions under a model
  /// that was fitted with it: left and right travel are a linear function of travel and turn.
  WheelPath(const std::vector<OdometrySample>& samples, double base_m);

  double beginS() const { return stamps_s_.front(); }
  double endS() const { return stamps_s_.back(); }
  bool empty() const { return steps_.empty(); }
  double baseM() const { return base_m_; }

  /// Motion between two times [s], in the robot's frame at `from_s`: x, y, heading. Beyond the
  /// record its first or last step goes on. @param T double or ceres::Jet.
  template <typename T>
  Eigen::Matrix<T, 3, 1> motion(const T& left_scale, const T& right_scale, const T& base_m, const T& from_s,
                                const T& to_s, double from_value_s, double to_value_s) const {
    Eigen::Matrix<T, 3, 1> pose(T(0.0), T(0.0), T(0.0));
    const std::size_t first = stepAt(from_value_s);
    const std::size_t last = stepAt(to_value_s);
    for (std::size_t i = first; i <= last; ++i) {
      T share(1.0);
      if (i == last) share -= (T(stamps_s_[i + 1]) - to_s) / (stamps_s_[i + 1] - stamps_s_[i]);
      if (i == first) share -= (from_s - T(stamps_s_[i])) / (stamps_s_[i + 1] - stamps_s_[i]);
      const WheelTravel& step = steps_[i];
      if (step.left == 0.0 && step.right == 0.0) continue;
      const T left = left_scale * step.left * share;
      const T right = right_scale * step.right * share;
      pose = advanced<T>(pose, (left + right) * 0.5, (right - left) / base_m);
    }
    return pose;
  }
  /// Speeds of both wheels at a time, as reported [m/s].
  WheelTravel speedAt(double time_s) const;
  /// Sum of the absolute travel of both wheels between two times, as reported [m].
  WheelTravel travelled(double from_s, double to_s) const;

  /// Covariance of motion(): noise of the wheels, sigma after one metre [m], through the arcs.
  Eigen::Matrix3d covariance(const WheelModel& model, double from_s, double to_s, double sigma_sqrtm) const;

 private:
  std::size_t stepAt(double time_s) const;

  double base_m_;
  std::vector<double> stamps_s_;    ///< one more than steps
  std::vector<WheelTravel> steps_;  ///< as reported
  std::vector<WheelTravel> sums_;   ///< absolute travel up to each stamp
};

}  // namespace vismem
