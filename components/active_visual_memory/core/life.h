/// @file Life of remembered things: how it grows and fades. Pure. SPEC M4.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// What one image said about a remembered thing, in rising order of how much it speaks for it.
enum class Sighting {
  kAbsent = 0,     ///< in view, not observed, and its place was seen bare
  kOutOfView = 1,  ///< not in view, or nothing can be said
  kCovered = 2,    ///< in view, but something else is in front of its place
  kObserved = 3,
};

struct LifeParams {
  double maximum = 100.0;
  double initial = 20.0;          ///< of something new
  double threshold = 1.0;         ///< below it a thing is forgotten
  double gain_per_s = 200.0;      ///< while observed
  double fade_per_s = 2.5;        ///< while out of view
  double absent_per_s = 80.0;     ///< while its place is seen bare
  double covered_per_s = 0.0;     ///< while covered
  StampUs tick_us = 0;            ///< life is counted in steps of this; 0: in every image
  double max_image_gap_s = 0.25;  ///< an image speaks for at most this long
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
  // With ticks one image stands for the whole tick; without, an image says nothing about a long gap before
  // it.
  const double seen_s = params.tick_us > 0 ? dt_s : std::min(dt_s, params.max_image_gap_s);
  switch (sighting) {
    case Sighting::kObserved:
      life += params.gain_per_s * seen_s;
      break;
    case Sighting::kCovered:
      life -= params.covered_per_s * dt_s;
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

/// M4: the inverse of life.
inline double uncertaintyOf(double life) {
  return life > 0.0 ? 1.0 / life : std::numeric_limits<double>::infinity();
}

}  // namespace vismem
