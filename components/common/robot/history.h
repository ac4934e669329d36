/// @file A short history of stamped samples with interpolation at a stamp. Pure. See G3.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>

#include "common/geometry/angles.h"
#include "common/robot/samples.h"

namespace vismem {

/// The interpolated value of a sample: joint angles or the pose.
inline PanTilt valueOf(const PanTiltSample& sample) {
  return {sample.pan_rad, sample.tilt_rad};
}
inline Pose2 valueOf(const OdometrySample& sample) {
  return sample.T_odom_robot;
}
inline PanTilt interpolate(const PanTilt& from, const PanTilt& to, double fraction) {
  return {from.pan_rad + fraction * (to.pan_rad - from.pan_rad),
          from.tilt_rad + fraction * (to.tilt_rad - from.tilt_rad)};
}

/// Invariant: stamps strictly increase. *Single-threaded*.
template <typename Sample>
class SampleHistory {
 public:
  using Value = decltype(valueOf(std::declval<Sample>()));

  /// @param span_us length of the history [us].
  /// @param max_gap_us no interpolation across longer gaps [us].
  SampleHistory(StampUs span_us, StampUs max_gap_us) : span_us_(span_us), max_gap_us_(max_gap_us) {}

  /// Samples that are not newer than the newest are ignored (a server may repeat its last one).
  void add(const Sample& sample) {
    if (!samples_.empty() && sample.stamp_us <= samples_.back().stamp_us) return;
    samples_.push_back(sample);
    while (samples_.front().stamp_us + span_us_ < sample.stamp_us) samples_.pop_front();
  }

  /// @return the value at the stamp; empty outside the history or inside a gap above max_gap_us.
  std::optional<Value> at(StampUs stamp_us) const {
    const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp_us,
                                        [](const Sample& s, StampUs stamp) { return s.stamp_us < stamp; });
    if (after == samples_.end()) return std::nullopt;
    if (after->stamp_us == stamp_us) return valueOf(*after);
    if (after == samples_.begin()) return std::nullopt;
    const auto before = std::prev(after);
    const StampUs gap = after->stamp_us - before->stamp_us;
    if (gap > max_gap_us_) return std::nullopt;
    const double fraction = static_cast<double>(stamp_us - before->stamp_us) / static_cast<double>(gap);
    return interpolate(valueOf(*before), valueOf(*after), fraction);
  }

  /// True if the newest sample is at or past the stamp: later samples do not change at(stamp_us).
  bool isPast(StampUs stamp_us) const { return !samples_.empty() && samples_.back().stamp_us >= stamp_us; }

  std::optional<Sample> latest() const {
    if (samples_.empty()) return std::nullopt;
    return samples_.back();
  }
  std::size_t size() const { return samples_.size(); }
  void clear() { samples_.clear(); }

 private:
  StampUs span_us_;
  StampUs max_gap_us_;
  std::deque<Sample> samples_;
};

}  // namespace vismem
