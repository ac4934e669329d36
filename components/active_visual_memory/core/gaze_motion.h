/// @file How the head gets to a target and follows it: saccade profiles, motion of targets. Pure. SPEC A4-A6.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// What an axis can do.
struct AxisLimits {
  double rate_radps = 2.6;
  double acceleration_radps2 = 17.4;
};

/// The time in which an axis at rest can turn by an angle and be at rest again [s].
double fastestTurn_s(double angle_rad, const AxisLimits& limits);
/// The same with the smoothest motion, that of least jerk.
double smoothestTurn_s(double angle_rad, const AxisLimits& limits);

/// One fast turn of the head from rest to rest, both axes together. *Pure value.* Each axis moves with least
/// jerk where that takes little longer than the fastest motion that its limits allow, else the fastest.
class Saccade {
 public:
  /// @param max_slowdown least jerk is taken up to this multiple of the fastest motion's time, >= 1.
  Saccade(StampUs start_us, const PanTilt& from, const PanTilt& to, const AxisLimits& pan,
          const AxisLimits& tilt, double max_slowdown);

  StampUs start() const { return start_us_; }
  StampUs end() const { return start_us_ + toStampUs(duration_s_); }
  double duration_s() const { return duration_s_; }
  /// Where the axes should be; at the target from end() on. @param to the target, which may have moved since.
  /// An axis that turns as fast as it can is at its target at once: its own limits shape its motion.
  PanTilt at(StampUs stamp_us, const PanTilt& to) const;

 private:
  StampUs start_us_;
  PanTilt from_;
  double duration_s_ = 0.0;
  bool smooth_pan_ = false;
  bool smooth_tilt_ = false;
};

/// Where a place that somebody keeps moving is and will be. *Single-threaded value.*
class TargetMotion {
 public:
  /// @param id of the target; another one begins anew.
  void observe(std::uint64_t id, const Eigen::Vector3d& p_odom, StampUs stamp_us);
  /// The place at a stamp at or after the last one observed, as far as it goes on as it did.
  Eigen::Vector3d at(StampUs stamp_us) const;
  const Eigen::Vector3d& velocity() const { return velocity_mps_; }

 private:
  std::uint64_t id_ = 0;
  bool known_ = false;
  Eigen::Vector3d p_odom_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  StampUs moved_us_ = 0;  ///< when the place was last another one
  StampUs seen_us_ = 0;
};

}  // namespace vismem
