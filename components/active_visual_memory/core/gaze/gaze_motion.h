/// @file Saccade profiles and motion of gaze targets. Pure. See A4, A5.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// Limits of a joint.
struct AxisLimits {
  double rate_radps = 2.6;
  double acceleration_radps2 = 17.4;
};

/// The time in which an axis at rest can turn by an angle and be at rest again [s].
double fastestTurn_s(double angle_rad, const AxisLimits& limits);
/// The same with minimum jerk (T. Flash, N. Hogan, 1985).
double smoothestTurn_s(double angle_rad, const AxisLimits& limits);

/// One saccade of the head from rest to rest, both axes together. *Pure value.* Each axis moves with minimum
/// jerk if that takes little longer than the fastest motion within its limits, else with the fastest motion.
class Saccade {
 public:
  /// @param max_slowdown  largest time of minimum jerk as a multiple of the fastest time, >= 1.
  Saccade(StampUs start_us, const PanTilt& from, const PanTilt& to, const AxisLimits& pan,
          const AxisLimits& tilt, double max_slowdown);

  StampUs end() const { return start_us_ + toStampUs(duration_s_); }
  double duration_s() const { return duration_s_; }
  /// Reference angles; those of the target from end() on. An axis with the fastest motion has the target as
  /// its reference at once: its own limits shape the motion.
  /// @param to  the target, which may have moved since.
  PanTilt at(StampUs stamp_us, const PanTilt& to) const;

 private:
  StampUs start_us_;
  PanTilt from_;
  double duration_s_ = 0.0;
  bool smooth_pan_ = false;
  bool smooth_tilt_ = false;
};

/// Constant-velocity prediction of a place that a client keeps moving. *Single-threaded value.*
class TargetMotion {
 public:
  /// @param id  of the target; another one begins anew.
  void observe(std::uint64_t id, const Eigen::Vector3d& p_odom, StampUs stamp_us);
  /// Predicted place at a stamp at or after the last observation.
  Eigen::Vector3d at(StampUs stamp_us) const;

 private:
  std::uint64_t id_ = 0;
  bool known_ = false;
  Eigen::Vector3d p_odom_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  StampUs moved_us_ = 0;  ///< stamp of the last change of the place
  StampUs seen_us_ = 0;
};

}  // namespace vismem
