/// @file Life of remembered elements.
/// Pure. Implements M4.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// Evidence of one image for an element, in rising order.
enum class Sighting {
  kAbsent = 0,     ///< in view, not observed, and its place was seen free
  kOutOfView = 1,  ///< not in view, or no evidence
  kOccluded = 2,   ///< in view, but its place is occluded
  kObserved = 3,
};

struct LifeParams {
  double maximum = 100.0;
  double initial = 20.0;          ///< of a new element
  double threshold = 1.0;         ///< below it an element is forgotten
  double gain_per_s = 200.0;      ///< while observed
  double fade_per_s = 2.5;        ///< while out of view
  double absent_per_s = 80.0;     ///< while its place is seen free
  double occluded_per_s = 0.0;    ///< while occluded
  StampUs tick_us = 0;            ///< life is counted in steps of this; 0: in each image
  double max_image_gap_s = 0.25;  ///< an image is evidence for at most this long
};

/// Cuts time into the steps in which life is counted. *Single-threaded value.*
class LifeClock {
 public:
  explicit LifeClock(StampUs tick_us = 0) : tick_us_(tick_us) {}

  /// @return seconds of life to count now, 0 until the next tick is due.
  double advance(StampUs stamp_us) {
    if (!last_us_) {
      last_us_ = stamp_us;
      return 0.0;
    }
    const StampUs passed = std::max<StampUs>(0, stamp_us - *last_us_);
    const StampUs counted = tick_us_ > 0 ? passed / tick_us_ * tick_us_ : passed;
    last_us_ = *last_us_ + counted;
    return toSeconds(counted);
  }
  void reset() { last_us_.reset(); }

 private:
  StampUs tick_us_;
  std::optional<StampUs> last_us_;
};

/// @param dt_s >= 0 since life was last counted. @return in [0, maximum].
inline double agedLife(double life, Sighting sighting, double dt_s, const LifeParams& params) {
  // With ticks one image is evidence for the whole tick; without, for at most max_image_gap_s before it.
  const double seen_s = params.tick_us > 0 ? dt_s : std::min(dt_s, params.max_image_gap_s);
  switch (sighting) {
    case Sighting::kObserved:
      life += params.gain_per_s * seen_s;
      break;
    case Sighting::kOccluded:
      life -= params.occluded_per_s * dt_s;
      break;
    case Sighting::kOutOfView:
      life -= params.fade_per_s * dt_s;
      break;
    case Sighting::kAbsent:
      life -= params.absent_per_s * seen_s;
      break;
  }
  return std::clamp(life, 0.0, params.maximum);
}

/// Uncertainty is the inverse of life.
inline double uncertaintyOf(double life) {
  return life > 0.0 ? 1.0 / life : std::numeric_limits<double>::infinity();
}

}  // namespace vismem
